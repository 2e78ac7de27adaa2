// Figures drawn by the page itself, from values: the same markup as the figures that stand in it.

const FIGURE_WIDTH = 960;
const PANEL_HEIGHT = 170;
// Room at the left, right, top and bottom of a panel.
const ROOM = { left: 66, right: 14, top: 24, bottom: 42 };
const INK = '#333';

// An axis of which the range is that of the values, in proportion or by the logarithm.
function axisOver(label, values, { kind = 'linear', low, high, fundamental } = {}) {
  const shown = values.filter(value => Number.isFinite(value) && (kind !== 'log' || value > 0));
  const least = low ?? Math.min(...shown, Infinity);
  const most = high ?? Math.max(...shown, -Infinity);
  let range = least < most ? [least, most] : [least - 0.5, least + 0.5];
  if (!Number.isFinite(least + most)) range = kind === 'log' ? [0.1, 1] : [0, 1];
  const room = low === undefined && high === undefined ? 0.05 : 0;
  if (kind === 'log') {
    const factor = (range[1] / range[0]) ** room;
    range = [range[0] / factor, range[1] * factor];
  } else {
    const margin = room * (range[1] - range[0]);
    range = [range[0] - margin, range[1] + margin];
  }
  return { kind, label, low: range[0], high: range[1], fundamental };
}

function crankAngle() {
  return { kind: 'degrees', label: 'crank angle (°)', low: 0, high: 360 };
}

// A figure of panels in two columns: { title, x, y, series: [{ label, colour, points: [x, y, x, y, …] }] }.
function drawFigure(heading, caption, panels) {
  const columns = Math.min(panels.length, 2);
  const cell = FIGURE_WIDTH / columns;
  const height = ROOM.top + PANEL_HEIGHT + ROOM.bottom;
  const rows = Math.ceil(panels.length / columns);
  const size = { width: FIGURE_WIDTH, height: rows * height, viewBox: `0 0 ${FIGURE_WIDTH} ${rows * height}` };
  const look = { 'font-family': 'Helvetica,Arial,Liberation Sans,sans-serif', fill: INK, 'stroke-linejoin': 'round', 'stroke-linecap': 'round' };
  const svg = element('svg', { ...size, ...look, 'aria-label': heading });
  svg.append(element('path', { fill: '#fff', d: `M0 0h${FIGURE_WIDTH}v${rows * height}H0z` }));
  panels.forEach((panel, i) => {
    const left = (i % columns) * cell + ROOM.left;
    const top = Math.floor(i / columns) * height + ROOM.top;
    svg.append(...drawPanel(panel, left, top, cell - ROOM.left - ROOM.right));
  });
  const box = html('div', { class: 'image' });
  box.append(svg);
  return html('figure', {}, html('h3', {}, heading), box, html('figcaption', {}, caption));
}

function drawPanel({ title, x, y, series }, left, top, width) {
  const attribute = axis => {
    const further = axis.names ?? (axis.fundamental ? [axis.fundamental] : []);
    return [axis.kind, axis.low, axis.high, axis.label, ...further].join('|');
  };
  const place = { x: left, y: top, width, height: PANEL_HEIGHT, overflow: 'hidden' };
  const plot = element('svg', { ...place, class: 'plot', 'data-title': title, 'data-x': attribute(x), 'data-y': attribute(y) });
  plot.append(element('path', { fill: 'none', stroke: '#e9e9e9' }));
  for (const one of series) {
    const group = element('g', { class: 'series', 'data-series': `${one.colour}|${one.label ?? ''}`, 'data-mark': one.mark ?? 'line' });
    group.values = Float32Array.from(one.points);
    // What stands at a point that stands by itself: a disc.
    const d = one.mark === 'points' ? 'M0 0m-2.2 0a2.2 2.2 0 1 0 4.4 0a2.2 2.2 0 1 0-4.4 0' : 'M0 0';
    group.append(element('path', { fill: one.mark === 'points' ? one.colour : 'none', stroke: one.colour, d }));
    plot.append(group);
  }
  const axisGroup = name => element('g', { class: `${name}-axis` }, element('path', { stroke: '#8a8a8a' }));
  const across = axisGroup('x');
  const up = axisGroup('y');
  const middle = top + PANEL_HEIGHT / 2;
  across.append(element('text', { x: left + width / 2, y: top + PANEL_HEIGHT + 33, 'font-size': 12, 'text-anchor': 'middle' }));
  up.append(element('text', { x: left - 50, y: middle, 'font-size': 12, 'text-anchor': 'middle', transform: `rotate(-90 ${left - 50} ${middle})` }));
  const frame = element('path', { fill: 'none', stroke: '#8a8a8a', d: `M${left} ${top}h${width}v${PANEL_HEIGHT}h${-width}z` });
  const name = element('text', { x: left, y: top - 7, 'font-size': 12, 'font-weight': 600 }, title);
  return [name, plot, frame, across, up];
}
