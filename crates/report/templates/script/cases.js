// The table of a dataset's cases, and the view of one: its curves, its labels, the command that makes it again.

const ROWS_AT_ONCE = 100;
const CASE_CURVE = '#0072b2';
const CASE_PRESSURE = '#d55e00';

// Some of the bytes that a text in base 64 stands for: four letters are three bytes.
function bytesWithin(text, first, count) {
  const group = Math.floor(first / 3);
  const bytes = bytesOf(text.slice(4 * group, 4 * Math.ceil((first + count) / 3)));
  return bytes.subarray(first - 3 * group, first - 3 * group + count);
}

class CaseTable {
  constructor(data, place) {
    this.data = data;
    this.columns = this.makeColumns();
    this.rows = data.ids.map((_, i) => i);
    this.limit = ROWS_AT_ONCE;
    this.place = place;
    place.append(...this.build());
    this.refresh();
    addEventListener('hashchange', () => this.follow());
    this.follow();
  }

  makeColumns() {
    const { ids, classes, splits, numbers, texts } = this.data;
    const link = i => html('a', { href: `#${ids[i]}` }, ids[i]);
    const of = (name, key, cell) => ({ name, key, cell: cell ?? (i => key(i)) });
    return [
      of('case', i => ids[i], link),
      of('class', i => classes[this.data.class[i]]?.name ?? ''),
      of('split', i => splits[this.data.split[i]] ?? ''),
      ...texts.map(({ name, values }) => of(name, i => values[i])),
      ...numbers.map(({ name, unit, values }) => ({
        ...of(name, i => values[i] ?? NaN, i => (values[i] === null ? '–' : number(values[i]))),
        unit,
        numeric: true,
      })),
    ];
  }

  build() {
    const choice = (name, options) => {
      const select = html('select', { 'aria-label': name }, html('option', { value: '' }, `${name}: all`));
      select.append(...options.map((text, i) => html('option', { value: i }, text)));
      select.addEventListener('change', () => this.refresh());
      return select;
    };
    const field = (type, label) => {
      const input = html('input', { type, placeholder: label, 'aria-label': label, size: 8, step: 'any' });
      input.addEventListener('input', () => this.refresh());
      return input;
    };
    const numeric = this.columns.filter(column => column.numeric);
    this.choices = {
      class: choice('class', this.data.classes.map(({ name }) => name)),
      split: choice('split', this.data.splits),
      column: choice('range of', numeric.map(({ name, unit }) => (unit ? `${name} (${unit})` : name))),
    };
    this.choices.column.firstChild.textContent = 'range of: …';
    this.from = field('number', 'from');
    this.to = field('number', 'to');
    this.find = field('search', 'find');
    this.counted = html('p', { class: 'more', role: 'status' });
    const heads = this.columns.map((column, i) => {
      const head = html('th', { scope: 'col', class: column.numeric ? 'n' : '' }, column.name);
      if (column.unit) head.append(html('br'), html('small', {}, column.unit));
      sortingHead(head, direction => this.sort(i, direction));
      return head;
    });
    this.body = html('tbody');
    const table = html('table', { class: 'fit' }, html('thead', {}, html('tr', {}, ...heads)), this.body);
    const csv = html('button', { type: 'button', onclick: () => download('cases.csv', 'text/csv', this.csv()) }, 'CSV');
    this.more = html('button', { type: 'button', onclick: () => this.refresh(this.limit + 10 * ROWS_AT_ONCE) }, 'more rows');
    const { class: classes, split, column } = this.choices;
    const scroll = { class: 'wide values rows', tabindex: 0, role: 'region', 'aria-label': 'Table of the cases' };
    this.view = html('section', { class: 'case', 'aria-live': 'polite' });
    return [
      html('p', { class: 'tools' }, classes, split, column, this.from, this.to, this.find, csv),
      this.counted,
      html('div', scroll, table),
      html('p', {}, this.more),
      this.view,
    ];
  }

  sort(column, direction) {
    const { key, numeric } = this.columns[column];
    const missing = value => (numeric && Number.isNaN(value) ? 1 : 0);
    this.rows.sort((a, b) => {
      const [left, right] = [key(a), key(b)];
      return missing(left) - missing(right) || direction * (left < right ? -1 : Number(left > right)) || a - b;
    });
    this.refresh();
  }

  // The rows that the filters leave, in the order of the table.
  chosen() {
    const { class: classes, split, column } = this.choices;
    const numeric = this.columns.filter(one => one.numeric)[column.value];
    const [from, to] = [this.from, this.to].map(input => parseFloat(input.value));
    const wanted = this.find.value.toLowerCase();
    const words = i => this.columns.filter(one => !one.numeric).map(one => one.key(i)).join(' ').toLowerCase();
    return this.rows.filter(i => (classes.value === '' || this.data.class[i] === +classes.value)
      && (split.value === '' || this.data.split[i] === +split.value)
      && (column.value === '' || !(numeric.key(i) < from) && !(numeric.key(i) > to))
      && (!wanted || words(i).includes(wanted)));
  }

  refresh(limit = ROWS_AT_ONCE) {
    this.limit = limit;
    const chosen = this.chosen();
    const row = i => html('tr', {}, ...this.columns.map(column =>
      html('td', { class: column.numeric ? 'n' : '' }, column.cell(i))));
    this.body.replaceChildren(...chosen.slice(0, limit).map(row));
    const { all, ids } = this.data;
    const listed = ids.length < all ? `, ${ids.length} of the dataset's ${all} in this page` : '';
    this.counted.textContent = `${chosen.length} of ${ids.length} cases${listed}; ${Math.min(limit, chosen.length)} rows shown.`;
    this.more.hidden = chosen.length <= limit;
  }

  csv() {
    const head = this.columns.map(({ name, unit }) => (unit ? `${name} (${unit})` : name));
    const rows = this.chosen().map(i => csvLine(this.columns.map(column => column.key(i))));
    return `${[csvLine(head), ...rows].join('\n')}\n`;
  }

  // Shows the case that the address names.
  follow() {
    const id = decodeURIComponent(location.hash.slice(1));
    const case_ = this.data.ids.indexOf(id);
    if (case_ >= 0) this.show(case_);
    else if (id.startsWith('case-') && !document.getElementById(id)) {
      this.view.replaceChildren(html('p', { class: 'missing' }, `${id} is not among the ${this.data.ids.length} cases of this page.`));
    } else return;
    this.view.scrollIntoView();
  }

  show(i) {
    const { data } = this;
    const chosen = this.chosen();
    const at = chosen.indexOf(i);
    const step = (text, to) => (to === undefined ? '' : html('a', { href: `#${data.ids[to]}` }, text));
    const facts = this.columns.slice(1).map(({ name, unit, cell }) =>
      html('div', {}, html('dt', {}, name), html('dd', {}, `${cell(i)}${unit ? ` ${unit}` : ''}`)));
    const warnings = (data.warnings[data.ids[i]] ?? []).map(text => html('p', { class: 'missing' }, text));
    const command = data.command.replace('CASE', data.ids[i]);
    this.view.replaceChildren(
      html('h3', {}, `${data.ids[i]}: ${data.classes[data.class[i]].name}`),
      html('p', { class: 'tools' }, step('previous', chosen[at - 1]), step('next', chosen[at + 1])),
      ...this.figures(i),
      html('dl', { class: 'facts' }, ...facts),
      ...warnings,
      html('p', {}, 'To simulate it again, in the folder of the dataset: ', html('code', {}, command)),
    );
    for (const figure of this.view.querySelectorAll('figure')) makeLive(figure);
    if (location.protocol.startsWith('http')) this.fetchWhole(data.ids[i]);
  }

  // Where the page is served, the case simulated again with all that the file has no room for.
  async fetchWhole(id) {
    const answer = await fetch(`cases/${encodeURIComponent(id)}.html`).catch(() => undefined);
    if (!answer?.ok || decodeURIComponent(location.hash.slice(1)) !== id) return;
    const whole = html('div');
    whole.innerHTML = await answer.text();
    // It has all that the page has of the case, and more.
    this.view.querySelectorAll('figure, .facts').forEach(one => one.remove());
    this.view.append(whole);
    for (const figure of whole.querySelectorAll('figure')) makeLive(figure);
  }

  // The curves of case `i`, channel by channel.
  figures(i) {
    const { channels, step } = this.data;
    if (!channels.length) return [html('p', { class: 'more' }, 'The recordings of this dataset are in MCAP files: open them in a viewer.')];
    if (i % step !== 0) return [html('p', { class: 'more' }, 'The page has no room for the curves of this case.')];
    const curves = channels.map(channel => this.curves(channel, i / step));
    const values = Math.max(...channels.map(({ revolution }) => revolution.count));
    const caption = `The last whole revolution of the first window: the lowest and the highest value in each ${number(720 / values, 3)}° of crank angle, `
      + 'drawn to 1/255 of their range. The spectrum is the rms over the revolutions; the envelope is that in the most impulsive band.';
    return [drawFigure('Recording', caption, curves.flat())];
  }

  curves({ name, unit, revolution, velocity, orders, envelope, volume }, at) {
    const read = ({ count, low, high, levels }) => {
      const bytes = bytesWithin(levels, at * count, count);
      return [...bytes].map(level => low[at] + (high[at] - low[at]) * level / 255);
    };
    const values = read(revolution);
    const angle = values.map((_, k) => 360 * (k + 0.5) / values.length);
    const panel = (title, x, y, xs, ys, colour) => {
      const points = xs.flatMap((value, k) => [value, ys[k]]);
      return { title, x, y, series: [{ colour, points }] };
    };
    const label = unit ? `${name} (${unit})` : name;
    const colour = orders ? CASE_CURVE : CASE_PRESSURE;
    const panels = [panel(`${name} over the crank angle`, crankAngle(), axisOver(label, values), angle, values, colour)];
    if (velocity) {
      const speeds = read(velocity);
      const [x, y] = [axisOver('velocity (m/s)', speeds), axisOver(label, values)];
      panels.push(panel('Portrait', x, y, [...speeds, speeds[0]], [...values, values[0]], colour));
    }
    if (orders) {
      const amplitudes = read(orders).map(power => 10 ** power);
      const places = amplitudes.map((_, k) => k + 1);
      const x = axisOver('order of crank speed', places, { low: 0, high: places.length, fundamental: 1 });
      panels.push(panel('Order spectrum', x, axisOver('amplitude (m/s²)', amplitudes, { kind: 'log' }), places, amplitudes, colour));
    }
    if (envelope) {
      const amplitudes = read(envelope);
      // A bar from zero at each order.
      const bars = amplitudes.flatMap((value, k) => [k + 1, 0, k + 1, value, NaN, NaN]);
      const x = axisOver('order of crank speed', [], { low: 0, high: amplitudes.length + 1, fundamental: 1 });
      const y = axisOver('amplitude (m/s²)', [0, ...amplitudes], { low: 0 });
      panels.push({ title: 'Envelope spectrum', x, y, series: [{ colour, points: bars }] });
    }
    if (volume.length) {
      const [x, y] = [axisOver('volume (dm³)', volume), axisOver(label, values)];
      panels.push(panel('p-V card', x, y, [...volume, volume[0]], [...values, values[0]], colour));
    }
    return panels;
  }
}
