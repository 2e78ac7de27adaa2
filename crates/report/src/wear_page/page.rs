//! The page itself.

use super::WearPage;
use crate::Error;
use crate::calibration_page::verdict::size;
use crate::calibration_page::{waveforms, words};
use crate::plate::{Numbers, Plate, Rendered, numbered_files};
use askama::Template;
use calibrate::wear::{Contact, Interval, JointWear, Results, Together, Verdict};

/// Digits of a clearance in mm.
const DECIMALS: usize = 4;

#[derive(Template)]
#[template(path = "wear_page.html")]
struct View<'a> {
    page: &'a WearPage,
    results: &'a Results,
    joints: Vec<(&'a str, &'a JointWear)>,
    verdict: String,
    warnings: Vec<String>,
    runs: Vec<(usize, Plate)>,
}

impl WearPage {
    /// The page as one HTML file that loads nothing from anywhere, and its figures.
    ///
    /// # Errors
    /// [`Error::Template`] if the template cannot be filled in.
    pub fn render(&self) -> Result<Rendered, Error> {
        let mut numbers = Numbers::default();
        let names = ["healthy machine", "with the clearances found"];
        let view = View {
            page: self,
            results: &self.results,
            joints: self.results.joints.iter().collect(),
            verdict: verdict(&self.results),
            warnings: warnings(&self.results),
            runs: numbers.give(waveforms::plates(&self.runs, names)),
        };
        let html = view.render()?;
        Ok(Rendered {
            html,
            figures: numbered_files("wear", view.runs.into_iter()),
        })
    }
}

/// The outcome in a few sentences.
fn verdict(results: &Results) -> String {
    let of = |wanted: Verdict| -> Vec<String> {
        let joints = results.joints.iter();
        let wanted = joints.filter(|(_, joint)| joint.verdict == wanted);
        wanted.map(|(path, _)| joint_name(path)).collect()
    };
    let mut said = match &of(Verdict::Worn)[..] {
        [] => "No joint is found to be worn.".to_owned(),
        worn => format!("Worn: {}.", worn.join(", ")),
    };
    for (wanted, word) in [
        (Verdict::Healthy, "Healthy"),
        (Verdict::Unclear, "Unclear"),
        (Verdict::NotIdentifiable, "Not identifiable"),
    ] {
        let joints = of(wanted);
        if !joints.is_empty() {
            said.push_str(&format!(" {word}: {}.", joints.join(", ")));
        }
    }
    said
}

/// What limits the trust in the outcome.
fn warnings(results: &Results) -> Vec<String> {
    let mut warnings = Vec::new();
    let misfit = size(results.fit.estimated);
    if !results.complete {
        warnings.push(
            "The search was stopped before its end: these are its best values. The same command with --resume continues from \
             there."
                .to_owned(),
        );
    }
    match (results.interval, results.timing_rad) {
        (Interval::Discrepancy, Some(timing)) => warnings.push(format!(
            "The model leaves {misfit} times the noise. The ranges include its discrepancy, an error of timing of {} mrad.",
            text::number(1e3 * timing, 2)
        )),
        (Interval::Scatter, _) => warnings.push(
            "The motion does not repeat itself. The ranges include its scatter.".to_owned(),
        ),
        (Interval::None, _) if results.complete => warnings.push(format!(
            "The model does not explain the recordings ({misfit} times the noise), and no interval can be given. \
             Calibrate the machine when it is healthy, or look for what is missing with explain-gap."
        )),
        _ => {}
    }
    if !results.scattering_runs.is_empty() {
        warnings.push(format!(
            "The motion of {} does not repeat itself: these runs were not compared.",
            results.scattering_runs.join(", ")
        ));
    }
    let pairs = results.together.iter().map(|Together { joints, correlation }| {
        let [a, b] = [&joints[0], &joints[1]].map(|path| joint_name(path));
        let sign = if *correlation > 0.0 { "the same" } else { "opposite" };
        format!(
            "The clearances of {a} and {b} are strongly correlated ({}): changes of both in {sign} direction look alike \
             in these recordings.",
            text::decimal(*correlation, 2)
        )
    });
    warnings.extend(pairs);
    warnings
}

/// The path of a joint in words: `throws.throw1.joints.big_end` is «throw1 big end».
fn joint_name(path: &str) -> String {
    let parts = path
        .split('.')
        .filter(|part| !matches!(*part, "joints" | "throws"));
    text::words(&parts.collect::<Vec<_>>().join(" "))
}

fn millimetres(metres: Option<f64>) -> String {
    metres.map_or("–".to_owned(), |c| text::number(1e3 * c, DECIMALS))
}

/// A clearance of a joint in as many decimals as it is known to.
fn as_close(joint: &JointWear, metres: Option<f64>) -> String {
    metres.map_or("–".to_owned(), |c| {
        text::decimal(1e3 * c, joint.decimals_mm())
    })
}

/// What the template asks for, formatted.
impl View<'_> {
    fn name(path: &str) -> String {
        text::capitalised(&joint_name(path))
    }

    fn word(joint: &JointWear) -> String {
        text::capitalised(joint.verdict.name())
    }

    fn healthy(joint: &JointWear) -> String {
        match joint.healthy_m {
            None => "ideal".to_owned(),
            stated => millimetres(stated),
        }
    }

    fn limit(joint: &JointWear) -> String {
        millimetres(Some(joint.worn_from_m))
    }

    fn radial(joint: &JointWear) -> String {
        as_close(joint, joint.clearance_m)
    }

    fn diametral(joint: &JointWear) -> String {
        as_close(joint, joint.diametral_clearance_m)
    }

    fn interval(joint: &JointWear) -> String {
        match joint.low_m.zip(joint.high_m) {
            Some((low, high)) => {
                let [low, high] = [low, high].map(|end| as_close(joint, Some(end)));
                format!("{low} to {high}")
            }
            None => "–".to_owned(),
        }
    }

    fn is_known(joint: &JointWear) -> bool {
        joint.verdict != Verdict::NotIdentifiable
    }

    fn channels(&self) -> String {
        let columns = self.results.channels.iter();
        let names: Vec<String> = columns.map(|column| words::column(column).0).collect();
        names.join(", ")
    }

    fn misfits(&self) -> [String; 2] {
        [self.results.fit.healthy, self.results.fit.estimated].map(size)
    }

    fn contact(&self) -> &'static str {
        match self.results.contact {
            Contact::MachineFile => "from the machine file",
            Contact::Fitted => "fitted",
        }
    }

    /// Where the pulses of tachos of unknown place come; empty where there is none.
    fn pulses(&self) -> String {
        let pulses = self.results.pulse_angles_rad.iter();
        let pulses = pulses
            .map(|(run, angle)| format!("{run}: {}\u{b0}", text::decimal(angle.to_degrees(), 1)));
        pulses.collect::<Vec<_>>().join(", ")
    }

    fn worn_from(&self) -> String {
        text::number(self.results.worn_from, 3)
    }

    fn left_out(&self) -> String {
        waveforms::left_out(&self.page.runs)
    }
}
