// Axes: where a value stands, which value stands at a place, tick marks, numbers as text.

// What is lower than this share of the lowest value of a logarithmic axis is drawn there.
const BELOW = 1e-3;
const SUPERSCRIPTS = '⁰¹²³⁴⁵⁶⁷⁸⁹';

// An axis from its attribute: kind|low|high|label, then names or the fundamental.
function readAxis(text) {
  const [kind, low, high, label, ...further] = text.split('|');
  const names = kind === 'names' ? further : [];
  const fundamental = kind === 'names' ? NaN : parseFloat(further[0]);
  const axis = { kind, low: +low, high: +high, label, names, fundamental };
  return { ...axis, home: { kind, low: axis.low, high: axis.high } };
}

function placeOf(axis, value) {
  if (axis.kind === 'log') {
    return Math.log(Math.max(value, axis.low * BELOW) / axis.low) / Math.log(axis.high / axis.low);
  }
  return (value - axis.low) / (axis.high - axis.low);
}

function valueAt(axis, place) {
  if (axis.kind === 'log') return axis.low * (axis.high / axis.low) ** place;
  return axis.low + place * (axis.high - axis.low);
}

function power(exponent) {
  const digits = [...String(Math.abs(exponent))].map(digit => SUPERSCRIPTS[digit]).join('');
  return `10${exponent < 0 ? '⁻' : ''}${digits}`;
}

function signed(text) {
  return text.replace('-', '−');
}

// Four significant digits, or as many as asked for.
function number(value, digits = 4) {
  if (!Number.isFinite(value)) return '–';
  const size = Math.abs(value);
  if (size !== 0 && (size < 1e-3 || size >= 1e6)) {
    const exponent = Math.floor(Math.log10(size));
    return `${signed(String(Number((value / 10 ** exponent).toPrecision(digits))))}·${power(exponent)}`;
  }
  return signed(String(Number(value.toPrecision(digits))));
}

// A value in words of its axis: «acceleration 12.3 m/s²».
function inWords(axis, value) {
  if (axis.kind === 'names') return axis.names[Math.round(value)] ?? '';
  const [, name, unit] = axis.label.match(/^(.*?)(?:\s*\(([^()]*)\))?$/);
  const known = axis.kind === 'log' && value < axis.home.low / 900 ? '≈ 0' : number(value);
  return `${name} ${known}${unit ? `${unit === '°' ? '' : ' '}${unit}` : ''}`.trim();
}

// Tick marks about every `spacing` of the `length` pixels: places with texts, and the label with its power of ten.
function tickMarks(axis, length, spacing) {
  const count = Math.max(length / spacing, 1);
  if (axis.kind === 'names') {
    const marks = axis.names.map((name, i) => [placeOf(axis, i), name]);
    return { marks: marks.filter(([at]) => at >= 0 && at <= 1), label: axis.label };
  }
  if (axis.kind === 'log' && axis.high >= 5 * axis.low) return { marks: powers(axis, count), label: axis.label };
  const range = axis.high - axis.low;
  const even = [1, 5, 10, 15, 30, 45, 60, 90, 180].find(step => step >= range / count && range > 4);
  return steps(axis, axis.kind === 'degrees' && even ? even : roundStep(range / count));
}

// The least of 1, 2, 5 times a power of ten that is at least `least`.
function roundStep(least) {
  const unit = 10 ** Math.floor(Math.log10(least));
  return unit * ([1, 2, 5].find(factor => factor * unit >= least * (1 - 1e-9)) ?? 10);
}

function steps(axis, step) {
  const slack = step * 1e-6;
  const values = [];
  for (let i = Math.ceil((axis.low - slack) / step); i * step <= axis.high + slack && values.length < 200; i++) {
    values.push(i * step);
  }
  const largest = Math.max(...values.map(Math.abs), 0);
  const far = largest >= 1e5 || (largest > 0 && largest < 1e-2);
  const exponent = far ? 3 * Math.floor(Math.log10(largest) / 3 + 1e-9) : 0;
  const unit = 10 ** exponent;
  const decimals = [0, 1, 2, 3, 4, 5, 6, 7, 8, 9].find(d => {
    const shifted = (step / unit) * 10 ** d;
    return Math.abs(shifted - Math.round(shifted)) < 1e-6 * Math.max(shifted, 1);
  }) ?? 3;
  const marks = values.map(value => [placeOf(axis, value), signed((value / unit).toFixed(decimals))]);
  if (!exponent) return { marks, label: axis.label };
  const label = axis.label.includes('(')
    ? axis.label.replace(/\((?=[^(]*$)/, `(${power(exponent)} `)
    : `${axis.label} (${power(exponent)})`;
  return { marks, label };
}

function powers(axis, count) {
  const [first, last] = [Math.floor(Math.log10(axis.low)), Math.ceil(Math.log10(axis.high))];
  const stride = Math.max(Math.ceil((last - first) / count), 1);
  const between = 3 * Math.log10(axis.high / axis.low) <= Math.max(count, 6) ? [1, 2, 5] : [1];
  const plain = (first >= -2 && last <= 4) || between.length > 1;
  const marks = [];
  for (let exponent = first; exponent <= last; exponent++) {
    if (exponent % stride !== 0) continue;
    for (const factor of between) {
      const value = factor * 10 ** exponent;
      marks.push([placeOf(axis, value), plain ? number(value, 1) : power(exponent)]);
    }
  }
  return marks.filter(([at]) => at >= -1e-9 && at <= 1 + 1e-9);
}
