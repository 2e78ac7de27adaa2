//! The image itself.

use super::axis::drawable;
use super::layout::{
    self, Frame, HEADING_SIZE, LABEL_SIZE, Placed, TICK_SIZE, TITLE_SIZE, text_width,
};
use super::rows::Figure;
use super::series::{Mark, Series};
use super::{decimate, live, palette};
use std::fmt::Write;
use text::{escape, shortened};

const FACES: &str = "Helvetica Neue,Helvetica,Arial,Liberation Sans,DejaVu Sans,sans-serif";
const TEXT: &str = "#333";
const FRAME: &str = "#8a8a8a";
const GRID: &str = "#e9e9e9";
/// Length of a sample line in the legend, and the room after an entry.
const KEY: f64 = 22.0;
const KEY_GAP: f64 = 18.0;

/// Where an image is going to stand.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Place {
    /// In a file or on paper: marks alone.
    File,
    /// On a page, whose script has it to work with: what is switched, zoomed and read off has a name and its values.
    Page,
}

impl Figure {
    /// The image as an `<svg>` element that stands alone.
    pub fn svg(&self) -> String {
        self.image(Place::File)
    }

    /// The same image for a page: axes and series carry what its script needs to draw them again.
    pub fn live_svg(&self) -> String {
        self.image(Place::Page)
    }

    fn image(&self, place: Place) -> String {
        let mut body = String::new();
        let mut top = 10.0;
        if !self.title.is_empty() {
            top += 18.0;
            let title = fitted(&self.title, self.width - 24.0, TITLE_SIZE);
            write_text(
                &mut body,
                [12.0, top],
                &title,
                TITLE_SIZE,
                "font-weight=\"600\"",
            );
            top += 10.0;
        }
        top = legend(&mut body, self, top, place);
        let layout = layout::place(self, top);
        for (baseline, heading) in &layout.headings {
            let heading = fitted(heading, self.width - 24.0, HEADING_SIZE);
            write_text(
                &mut body,
                [12.0, *baseline],
                &heading,
                HEADING_SIZE,
                "font-weight=\"600\"",
            );
        }
        for cell in &layout.cells {
            panel(&mut body, cell, place);
        }
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" role=\"img\" aria-label=\"{}\" width=\"{width}\" \
             height=\"{height}\" viewBox=\"0 0 {width} {height}\" font-family=\"{FACES}\" fill=\"{TEXT}\" \
             stroke-linejoin=\"round\" stroke-linecap=\"round\"><path fill=\"#fff\" d=\"M0 0h{width}v{height}H0z\"/>{body}</svg>",
            escape(name(self)),
            width = px(self.width),
            height = px(layout.height),
        )
    }
}

/// The description for readers who cannot see the image: the title, or that of the first panel.
fn name(figure: &Figure) -> &str {
    let titles = figure
        .rows
        .iter()
        .flatten()
        .map(|panel| panel.title.as_str());
    std::iter::once(figure.title.as_str())
        .chain(titles)
        .find(|title| !title.is_empty())
        .unwrap_or("figure")
}

/// The named series, each once, in lines that fit the image; returns where the panels may begin.
fn legend(out: &mut String, figure: &Figure, top: f64, place: Place) -> f64 {
    let mut entries: Vec<&Series> = Vec::new();
    let series = figure.rows.iter().flatten().flat_map(|panel| &panel.series);
    for series in series.filter(|series| !series.layer.is_of_step()) {
        let known = |e: &&Series| e.label == series.label && e.colour == series.colour;
        if !series.label.is_empty() && !entries.iter().any(known) {
            entries.push(series);
        }
    }
    let (mut left, mut baseline) = (12.0, top + 14.0);
    for series in &entries {
        let label = fitted(&series.label, figure.width - 2.0 * KEY - 24.0, LABEL_SIZE);
        let width = KEY + 6.0 + text_width(&label, LABEL_SIZE);
        if left > 12.0 && left + width > figure.width - 12.0 {
            (left, baseline) = (12.0, baseline + 18.0);
        }
        let middle = baseline - 4.0;
        if place == Place::Page {
            let _ = write!(
                out,
                "<g class=\"key\" data-series=\"{}\">",
                live::name(series)
            );
        }
        let (kind, sample) = match series.mark {
            // A dot of a pixel is too small for a sample.
            Mark::Dots | Mark::WideDots => (Mark::Points, vec![[left + KEY / 2.0, middle]]),
            separate if separate.is_separate() => (separate, vec![[left + KEY / 2.0, middle]]),
            Mark::Band => (
                Mark::Band,
                vec![
                    [left, middle - 4.0],
                    [left + KEY, middle - 4.0],
                    [left + KEY, middle + 4.0],
                    [left, middle + 4.0],
                ],
            ),
            Mark::Area => (
                Mark::Area,
                vec![[left, middle - 4.0], [left + KEY, middle - 4.0]],
            ),
            _ => (Mark::BoldLine, vec![[left, middle], [left + KEY, middle]]),
        };
        mark(
            out,
            &Series::new("", series.colour, kind, []),
            &[sample],
            baseline,
        );
        write_text(out, [left + KEY + 6.0, baseline], &label, LABEL_SIZE, "");
        if place == Place::Page {
            out.push_str("</g>");
        }
        left += width + KEY_GAP;
    }
    if entries.is_empty() {
        top
    } else {
        baseline + 8.0
    }
}

/// One panel: grid, guides, data, frame, words.
fn panel(out: &mut String, cell: &Placed<'_>, place: Place) {
    let Frame {
        left,
        top,
        width,
        height,
    } = cell.frame;
    let bottom = top + height;
    if !cell.panel.title.is_empty() {
        let title = fitted(&cell.panel.title, width + 10.0, LABEL_SIZE);
        write_text(
            out,
            [left, top - 7.0],
            &title,
            LABEL_SIZE,
            "font-weight=\"600\"",
        );
    }
    // The inner <svg> cuts off what lies outside the axes.
    let _ = write!(
        out,
        "<svg x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" overflow=\"hidden\"{}>",
        px(left),
        px(top),
        px(width),
        px(height),
        match place {
            Place::File => String::new(),
            Place::Page => live::axes(cell),
        }
    );
    let xs = cell
        .x
        .ticks
        .iter()
        .map(|(at, _)| format!("M{} 0v{}", px(at * width), px(height)));
    let ys = cell
        .y
        .ticks
        .iter()
        .map(|(at, _)| format!("M0 {}h{}", px((1.0 - at) * height), px(width)));
    let _ = write!(
        out,
        "<path fill=\"none\" stroke=\"{GRID}\" d=\"{}\"/>",
        xs.chain(ys).collect::<String>()
    );
    guides(out, cell);
    fields(out, cell, place);
    for series in &cell.panel.series {
        if place == Place::File && series.layer.is_of_step() {
            continue;
        }
        let stretches = in_pixels(series, cell);
        if place == Place::Page {
            let values = live::values(series, &stretches, cell);
            let _ = write!(out, "<g{values}>");
        }
        mark(out, series, &stretches, height);
        if place == Place::Page {
            out.push_str("</g>");
        }
    }
    out.push_str("</svg>");
    let _ = write!(
        out,
        "<path fill=\"none\" stroke=\"{FRAME}\" d=\"M{} {}h{}v{}h-{}z\"/>",
        px(left),
        px(top),
        px(width),
        px(height),
        px(width)
    );
    if !cell.panel.note.is_empty() {
        let middle = [left + width / 2.0, top + height / 2.0 + 4.0];
        let note = fitted(&cell.panel.note, width - 10.0, LABEL_SIZE);
        write_text(
            out,
            middle,
            &note,
            LABEL_SIZE,
            "text-anchor=\"middle\" fill=\"#777\" font-style=\"italic\"",
        );
    }
    let mut axis = |name: &str, draw: &dyn Fn(&mut String)| match place {
        Place::File => draw(out),
        Place::Page => {
            let _ = write!(out, "<g class=\"{name}\">");
            draw(out);
            out.push_str("</g>");
        }
    };
    if cell.x_shown {
        axis("x-axis", &|out| x_axis(out, cell, bottom));
    }
    if cell.y_shown {
        axis("y-axis", &|out| y_axis(out, cell, left));
    }
}

fn x_axis(out: &mut String, cell: &Placed<'_>, bottom: f64) {
    let Frame { left, width, .. } = cell.frame;
    let marks: String = cell
        .x
        .ticks
        .iter()
        .map(|(at, _)| format!("M{} {}v4", px(left + at * width), px(bottom)))
        .collect();
    let _ = write!(out, "<path stroke=\"{FRAME}\" d=\"{marks}\"/>");
    for (at, label) in &cell.x.ticks {
        write_text(
            out,
            [left + at * width, bottom + 16.0],
            label,
            TICK_SIZE,
            "text-anchor=\"middle\"",
        );
    }
    let label = fitted(&cell.x.label, width + 30.0, LABEL_SIZE);
    write_text(
        out,
        [left + width / 2.0, bottom + 33.0],
        &label,
        LABEL_SIZE,
        "text-anchor=\"middle\"",
    );
}

fn y_axis(out: &mut String, cell: &Placed<'_>, left: f64) {
    let Frame { top, height, .. } = cell.frame;
    let place = |at: &f64| top + (1.0 - at) * height;
    let marks: String = cell
        .y
        .ticks
        .iter()
        .map(|(at, _)| format!("M{} {}h-4", px(left), px(place(at))))
        .collect();
    let _ = write!(out, "<path stroke=\"{FRAME}\" d=\"{marks}\"/>");
    for (at, label) in &cell.y.ticks {
        write_text(
            out,
            [left - 7.0, place(at) + 4.0],
            label,
            TICK_SIZE,
            "text-anchor=\"end\"",
        );
    }
    let label = fitted(&cell.y.label, height + 20.0, LABEL_SIZE);
    let (x, y) = (px(left - cell.y_room + 13.0), px(top + height / 2.0));
    let turned = format!("text-anchor=\"middle\" transform=\"rotate(-90 {x} {y})\"");
    write_text(
        out,
        [left - cell.y_room + 13.0, top + height / 2.0],
        &label,
        LABEL_SIZE,
        &turned,
    );
}

/// The circles of the panel as ellipses of the axes' units.
fn guides(out: &mut String, cell: &Placed<'_>) {
    for circle in &cell.panel.circles {
        let [x, y] = pixel(circle.centre, cell);
        let [edge, _] = pixel([circle.centre[0] + circle.radius, circle.centre[1]], cell);
        let [_, top] = pixel([circle.centre[0], circle.centre[1] + circle.radius], cell);
        if [x, y, edge, top].into_iter().all(drawable) {
            let (rx, ry) = (px((edge - x).abs()), px((y - top).abs()));
            let _ = write!(
                out,
                "<ellipse cx=\"{}\" cy=\"{}\" rx=\"{rx}\" ry=\"{ry}\" fill=\"#f3f5f7\" stroke=\"#9aa3ab\" stroke-width=\"2\"/>",
                px(x),
                px(y)
            );
        }
    }
}

/// The fields of the panel with their letters.
fn fields(out: &mut String, cell: &Placed<'_>, place: Place) {
    for field in &cell.panel.fields {
        if place == Place::File && field.layer.is_of_step() {
            continue;
        }
        let [x, y] = field.at;
        let ([left, top], [right, bottom]) = (
            pixel([x - 0.5, y + 0.5], cell),
            pixel([x + 0.5, y - 0.5], cell),
        );
        if ![left, top, right, bottom].into_iter().all(drawable) {
            continue;
        }
        let _ = write!(
            out,
            "<path{} fill=\"{}\" stroke=\"#fff\" d=\"M{} {}H{}V{}H{}z\"/>",
            match place {
                Place::File => String::new(),
                Place::Page => live::field(field),
            },
            palette::hex(field.fill),
            px(left),
            px(top),
            px(right),
            px(bottom),
            px(left)
        );
        let letters = fitted(&field.letters, right - left, TICK_SIZE);
        let middle = [f64::midpoint(left, right), f64::midpoint(top, bottom) + 4.0];
        let style = format!(
            "text-anchor=\"middle\" fill=\"{}\"{}",
            palette::writing_on(field.fill),
            match place {
                Place::File => String::new(),
                Place::Page => live::layer(field.layer),
            }
        );
        write_text(out, middle, &letters, TICK_SIZE, &style);
    }
}

/// A point in pixels from the upper left corner of the plotting area.
fn pixel(point: [f64; 2], cell: &Placed<'_>) -> [f64; 2] {
    let Frame { width, height, .. } = cell.frame;
    [
        cell.x.place(point[0]) * width,
        (1.0 - cell.y.place(point[1])) * height,
    ]
}

/// The stretches of the series between interruptions, in pixels and as few as needed.
fn in_pixels(series: &Series, cell: &Placed<'_>) -> Vec<Vec<[f64; 2]>> {
    // What lies far outside the frame is drawn at a place that is far outside, too.
    let place = |&point: &[f64; 2]| pixel(point, cell).map(|v| v.clamp(-1e5, 1e5));
    let stretches = series
        .points
        .split(|point| !drawable(point[0]) || !drawable(point[1]));
    let stretches = stretches.map(|stretch| stretch.iter().map(place).collect::<Vec<_>>());
    if series.mark.is_separate() {
        let all: Vec<[f64; 2]> = stretches.flatten().collect();
        return vec![match series.mark {
            Mark::Dots | Mark::WideDots => decimate::dots(&all),
            _ => decimate::points(&all),
        }];
    }
    let lines: Vec<Vec<[f64; 2]>> = stretches.filter(|stretch| stretch.len() > 1).collect();
    // A line that fills the panel needs no more vertices than this to look full.
    let most = (cell.frame.width * cell.frame.height / 12.0).clamp(1_000.0, 6_000.0) as usize;
    let each = most / lines.len().max(1);
    lines
        .iter()
        .map(|line| decimate::line(line, each))
        .collect()
}

/// Stretches of a series in pixels, drawn as the series is to look; an area reaches down to
/// `bottom`.
fn mark(out: &mut String, series: &Series, stretches: &[Vec<[f64; 2]>], bottom: f64) {
    let colour = palette::hex(series.colour);
    let cycle = palette::cycle(series.colour);
    let stroke = |width: f64, opacity: f64| {
        let dashes = match cycle {
            0 => String::new(),
            n => format!(" stroke-dasharray=\"{} 3\"", 12 / n.min(4)),
        };
        format!(
            "fill=\"none\" stroke=\"{colour}\" stroke-width=\"{width}\" stroke-opacity=\"{opacity}\"{dashes}"
        )
    };
    let shape = match series.mark {
        Mark::Points => Some(SHAPES[cycle % SHAPES.len()]),
        Mark::Rings | Mark::Discs => Some(RING),
        _ => None,
    };
    let data: String = match (series.mark, shape) {
        (_, Some(shape)) => stretches
            .iter()
            .flatten()
            .map(|p| format!("M{} {}{shape}", px(p[0]), px(p[1])))
            .collect(),
        (Mark::Dots | Mark::WideDots, _) => stretches.iter().map(|stretch| dots(stretch)).collect(),
        _ => stretches.iter().map(|stretch| path(stretch)).collect(),
    };
    if data.is_empty() {
        return;
    }
    if series.mark == Mark::Area {
        let _ = write!(out, "<path fill=\"{colour}\" fill-opacity=\".25\" d=\"");
        for stretch in stretches {
            if let (Some(first), Some(last)) = (stretch.first(), stretch.last()) {
                let down = format!("L{} {}H{}z", px(last[0]), px(bottom), px(first[0]));
                let _ = write!(out, "{}{down}", path(stretch));
            }
        }
        out.push_str("\"/>");
    }
    let style = match series.mark {
        Mark::FaintLine => stroke(0.8, 0.4),
        Mark::HairLine => stroke(0.6, 1.0),
        Mark::Line | Mark::Area => stroke(1.0, 1.0),
        Mark::BoldLine => stroke(2.0, 1.0),
        Mark::Points => format!("fill=\"{colour}\" fill-opacity=\".6\""),
        Mark::Rings => format!("fill=\"none\" stroke=\"{colour}\" stroke-width=\"1.4\""),
        Mark::Discs => format!("fill=\"{colour}\""),
        Mark::Dots => format!("fill=\"none\" stroke=\"{colour}\" stroke-width=\"2\""),
        Mark::WideDots => {
            format!("fill=\"none\" stroke=\"{colour}\" stroke-width=\"3.8\" stroke-opacity=\".45\"")
        }
        Mark::Band => format!("fill=\"{colour}\" fill-opacity=\".25\""),
    };
    let _ = write!(out, "<path {style} d=\"{data}\"/>");
}

/// Outlines of point marks, from the middle: disc, square, triangle, diamond.
const SHAPES: [&str; 4] = [
    "m-2.2 0a2.2 2.2 0 1 0 4.4 0a2.2 2.2 0 1 0-4.4 0",
    "m-2-2h4v4h-4z",
    "m0-2.8l2.6 4.6h-5.2z",
    "m0-2.9l2.9 2.9-2.9 2.9-2.9-2.9z",
];

/// Outline of an open circle, from the middle.
const RING: &str = "m-3.2 0a3.2 3.2 0 1 0 6.4 0a3.2 3.2 0 1 0-6.4 0";

/// Strokes of no length, which round caps make dots, each as its difference from the one before.
fn dots(points: &[[f64; 2]]) -> String {
    let mut out = String::new();
    let mut last = [0, 0];
    for point in points.iter().map(|p| p.map(|v| (v * 10.0).round() as i64)) {
        let letter = if out.is_empty() { 'M' } else { 'm' };
        let _ = write!(
            out,
            "{letter}{} {}h0",
            tenth(point[0] - last[0]),
            tenth(point[1] - last[1])
        );
        last = point;
    }
    out
}

/// A polyline as path data: tenths of pixels, each vertex as its difference from the one before.
fn path(points: &[[f64; 2]]) -> String {
    let tenths = |p: &[f64; 2]| p.map(|v| (v * 10.0).round() as i64);
    let mut out = String::new();
    let mut last: Option<[i64; 2]> = None;
    let mut separator = 'l';
    for point in points.iter().map(tenths) {
        let [x, y] = point;
        match last {
            None => {
                let _ = write!(out, "M{} {}", tenth(x), tenth(y));
            }
            Some([from_x, from_y]) => {
                let (dx, dy) = (x - from_x, y - from_y);
                if dx == 0 && dy == 0 {
                    continue;
                }
                out.push(separator);
                separator = ' ';
                let _ = write!(out, "{} {}", tenth(dx), tenth(dy));
            }
        }
        last = Some(point);
    }
    out
}

/// A count of tenths as the shortest decimal number.
fn tenth(n: i64) -> String {
    let sign = if n < 0 { "-" } else { "" };
    match (n.unsigned_abs() / 10, n.unsigned_abs() % 10) {
        (whole, 0) => format!("{sign}{whole}"),
        (0, part) => format!("{sign}.{part}"),
        (whole, part) => format!("{sign}{whole}.{part}"),
    }
}

/// A length to a tenth of a pixel.
fn px(value: f64) -> String {
    tenth((value * 10.0).round() as i64)
}

/// As much of the text as fits the width.
fn fitted(text: &str, width: f64, size: f64) -> String {
    let needed = text_width(text, size);
    if needed <= width {
        return text.to_owned();
    }
    shortened(
        text,
        (text.chars().count() as f64 * (width / needed)).max(1.0) as usize,
    )
}

fn write_text(out: &mut String, [x, y]: [f64; 2], text: &str, size: f64, attributes: &str) {
    let space = if attributes.is_empty() { "" } else { " " };
    let _ = write!(
        out,
        "<text x=\"{}\" y=\"{}\" font-size=\"{size}\"{space}{attributes}>{}</text>",
        px(x),
        px(y),
        escape(text)
    );
}
