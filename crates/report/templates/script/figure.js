// A figure to work with: values under the cursor, zoom, switches in the legend, cursors at orders, export.

function html(name, attributes = {}, ...children) {
  const made = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) {
    if (key.startsWith('on')) made.addEventListener(key.slice(2), value);
    else if (value !== false) made.setAttribute(key, value === true ? '' : value);
  }
  made.append(...children);
  return made;
}

// Offers a text as a file.
function download(name, type, text) {
  const link = html('a', { href: URL.createObjectURL(new Blob([text], { type })), download: name });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}

function csvLine(cells) {
  return cells.map(cell => (/[",\n]/.test(cell) ? `"${String(cell).replaceAll('"', '""')}"` : cell)).join(',');
}

const MOST_TABLE_ROWS = 1000;
// Cursors closer than this many pixels hide what they point at: only the first few are shown.
const CLOSEST_ORDERS = 8;
const FIRST_ORDERS = 10;
// A drag of fewer pixels is a click.
const LEAST_DRAG = 6;

class InteractiveFigure {
  constructor(box) {
    this.box = box;
    this.svg = box.querySelector('svg');
    this.panels = [...this.svg.querySelectorAll('.plot')].map(svg => new Panel(svg));
    this.heading = box.querySelector('h3')?.textContent ?? 'figure';
    this.waiting = new Set();
    this.tip = box.appendChild(html('p', { class: 'tip', role: 'status' }));
    this.svg.setAttribute('role', 'group');
    for (const panel of this.panels) this.addPanel(panel);
    // What the page itself drew has neither paths nor ticks yet.
    this.panels.filter(panel => panel.series.some(series => series.group.values)).forEach(panel => panel.draw());
    for (const key of this.svg.querySelectorAll('.key')) this.addSwitch(key);
    box.insertBefore(this.tools(), this.svg.parentElement);
    if (box.querySelector('.sections')) this.sections = new Sections(this);
    this.svg.addEventListener('pointermove', event => this.moved(event));
    this.svg.addEventListener('pointerleave', () => this.clear());
    this.svg.addEventListener('pointerdown', event => this.pressed(event));
    this.svg.addEventListener('pointerup', event => this.released(event));
    this.svg.addEventListener('pointercancel', () => this.stopDrag());
    this.svg.addEventListener('dblclick', () => this.reset());
    this.svg.addEventListener('wheel', event => this.turned(event), { passive: false });
  }

  addPanel(panel) {
    const hit = { class: 'hit', width: panel.width, height: panel.height, tabindex: 0, role: 'application' };
    const keys = 'arrow keys move the cursor, plus and minus zoom, 0 shows all';
    panel.hit = panel.svg.appendChild(element('rect', { ...hit, 'aria-label': `${panel.words}; ${keys}` }));
    panel.hit.addEventListener('keydown', event => this.typed(panel, event));
    panel.hit.addEventListener('blur', () => this.clear());
  }

  addSwitch(key) {
    const { x, y, width, height } = key.getBBox();
    key.prepend(element('rect', { x: x - 3, y: y - 3, width: width + 6, height: height + 6, fill: 'transparent' }));
    const label = key.dataset.series.slice(key.dataset.series.indexOf('|') + 1);
    const state = { tabindex: 0, role: 'switch', 'aria-checked': true, 'aria-label': label };
    for (const [name, value] of Object.entries(state)) key.setAttribute(name, value);
    const turn = () => {
      const shown = key.getAttribute('aria-checked') !== 'true';
      key.setAttribute('aria-checked', shown);
      const series = this.panels.flatMap(panel => panel.series);
      for (const one of series.filter(one => one.key === key.dataset.series)) {
        one.group.style.display = shown ? '' : 'none';
      }
    };
    key.addEventListener('click', turn);
    key.addEventListener('keydown', event => {
      if (event.key !== 'Enter' && event.key !== ' ') return;
      event.preventDefault();
      turn();
    });
  }

  tools() {
    const button = (text, title, onclick) => html('button', { type: 'button', title, onclick }, text);
    const bar = html('div', { class: 'tools', role: 'toolbar', 'aria-label': `Tools of: ${this.heading}` });
    if (this.panels.some(panel => !panel.fixed)) {
      bar.append(
        button('+', 'Zoom in', () => this.zoomAll(0.5)),
        button('−', 'Zoom out', () => this.zoomAll(2)),
        button('Reset', 'Show all (double click)', () => this.reset()),
      );
    }
    for (const direction of ['x', 'y']) {
      const able = this.panels.filter(panel => panel.canBeLog(direction));
      if (!able.length) continue;
      const isLog = () => able.every(panel => panel.axes[direction].kind === 'log');
      const text = `log ${direction}`;
      const pressed = html('button', { type: 'button', 'aria-pressed': isLog(), title: `Logarithmic ${direction} axis` }, text);
      pressed.addEventListener('click', () => {
        const kind = isLog() ? 'linear' : 'log';
        for (const panel of able) panel.setKind(direction, kind);
        pressed.setAttribute('aria-pressed', isLog());
        this.redraw(able);
      });
      this[`${direction}Button`] = { pressed, isLog };
      bar.append(pressed);
    }
    if (this.panels.some(panel => panel.axes.x.fundamental > 0)) bar.append(this.orderCursors());
    bar.append(
      button('Table', 'The values as a table', () => this.toggleTable()),
      button('CSV', 'The drawn values as a file', () => download(`${this.fileName()}.csv`, 'text/csv', this.csv())),
      button('SVG', 'The figure as it stands', () => download(`${this.fileName()}.svg`, 'image/svg+xml', this.image())),
    );
    return bar;
  }

  fileName() {
    return this.heading.toLowerCase().replace(/[^a-z0-9]+/g, '-').replace(/^-|-$/g, '') || 'figure';
  }

  // Cursors at the multiples of a chosen order.
  orderCursors() {
    const choices = [['', 'off'], ['1', '1×'], ['2', '2×'], ['3', '3×'], ['0.5', '½×']];
    const select = html('select', {}, ...choices.map(([value, text]) => html('option', { value }, text)));
    select.addEventListener('change', () => {
      this.order = parseFloat(select.value);
      this.redraw(this.panels);
    });
    return html('label', {}, 'orders ', select);
  }

  drawOrders(panel) {
    panel.orders?.remove();
    const step = this.order * panel.axes.x.fundamental;
    if (!(step > 0)) return;
    panel.orders = panel.svg.insertBefore(element('g', { class: 'orders' }), panel.over);
    const { low, high } = panel.axes.x;
    const apart = panel.pixel('x', low + step) - panel.pixel('x', low);
    const last = apart < CLOSEST_ORDERS ? FIRST_ORDERS : Infinity;
    let labelled = -Infinity;
    for (let k = Math.max(Math.ceil(low / step - 1e-9), 1); k * step <= high && k <= last; k++) {
      const x = panel.pixel('x', k * step);
      panel.orders.append(element('path', { d: `M${x} 0v${panel.height}` }));
      if (x - labelled < 30) continue;
      panel.orders.append(element('text', { x: x + 3, y: 11, 'font-size': 10 }, `${number(k * this.order)}×`));
      labelled = x;
    }
  }

  // Panels that show the same quantity over the same range move together.
  linked(panel, direction) {
    const { label, home } = panel.axes[direction];
    return this.panels.filter(other => {
      const axis = other.axes[direction];
      return !other.fixed && axis.label === label && axis.home.low === home.low && axis.home.high === home.high;
    });
  }

  setRange(panel, direction, [from, to]) {
    const axis = panel.axes[direction];
    const [low, high] = [valueAt(axis, from), valueAt(axis, to)];
    if (!(high - low > 1e-9 * Math.max(Math.abs(low), Math.abs(high)))) return;
    const linked = this.linked(panel, direction);
    for (const other of linked) Object.assign(other.axes[direction], { low, high });
    this.redraw(linked);
  }

  zoom(panel, factor, [atX, atY] = [0.5, 0.5]) {
    const around = at => [at - at * factor, at + (1 - at) * factor];
    if (panel.axes.x.kind !== 'names') this.setRange(panel, 'x', around(atX));
    if (panel.axes.y.kind !== 'names') this.setRange(panel, 'y', around(atY));
  }

  zoomAll(factor) {
    const done = { x: new Set(), y: new Set() };
    for (const panel of this.panels.filter(panel => !panel.fixed)) {
      for (const direction of ['x', 'y']) {
        if (done[direction].has(panel) || panel.axes[direction].kind === 'names') continue;
        this.linked(panel, direction).forEach(other => done[direction].add(other));
        this.setRange(panel, direction, [0.5 - factor / 2, 0.5 + factor / 2]);
      }
    }
  }

  reset() {
    for (const panel of this.panels) {
      for (const axis of Object.values(panel.axes)) Object.assign(axis, axis.home);
    }
    for (const one of [this.xButton, this.yButton]) one?.pressed.setAttribute('aria-pressed', one.isLog());
    this.redraw(this.panels);
  }

  // Draws panels again before the next frame, each once.
  redraw(panels) {
    if (!this.waiting.size) {
      requestAnimationFrame(() => {
        for (const panel of this.waiting) {
          panel.draw();
          this.drawOrders(panel);
        }
        this.waiting.clear();
      });
    }
    panels.forEach(panel => this.waiting.add(panel));
  }

  // The panel under the pointer and the place in it, pixels; beyond its frame if it is dragged.
  place(event, panel) {
    const there = new DOMPoint(event.clientX, event.clientY).matrixTransform(this.svg.getScreenCTM().inverse());
    const inside = ({ left, top, width, height }) =>
      there.x >= left && there.x <= left + width && there.y >= top && there.y <= top + height;
    const found = panel ?? this.panels.find(inside);
    return found && { panel: found, x: there.x - found.left, y: there.y - found.top };
  }

  moved(event) {
    if (this.drag) return this.dragged(event);
    const at = this.place(event);
    if (!at) return this.clear();
    if (at.panel.fixed) return this.showField(at);
    const near = at.panel.nearest(at.x, at.y);
    return near.series ? this.show(at.panel, near) : this.clear();
  }

  // Marks a vertex, its x in all panels of that axis, and says what is there.
  show(panel, near) {
    this.clear();
    this.current = { panel, near };
    this.sections?.show(near.x);
    const ink = { class: 'cursor' };
    const others = this.panels.filter(other => other.axes.x.label === panel.axes.x.label && !other.fixed);
    for (const other of new Set([panel, ...others])) {
      const x = other.pixel('x', near.x);
      if (!panel.fixed) other.over.append(element('path', { ...ink, d: `M${x} 0v${other.height}` }));
      if (other === panel) continue;
      let row = 0;
      for (const series of other.series.filter(series => series.shown && !series.guide).slice(0, 6)) {
        const y = series.at(near.x);
        if (Number.isNaN(y)) continue;
        const left = x > other.width / 2;
        const spot = { x: left ? x - 5 : x + 5, y: 13 + 13 * row++, 'text-anchor': left ? 'end' : 'start', 'font-size': 11 };
        other.over.append(element('text', { ...spot, fill: series.colour }, number(y)));
      }
    }
    const [cx, cy] = [panel.pixel('x', near.x), panel.pixel('y', near.y)];
    panel.over.append(element('circle', { ...ink, cx, cy, r: 4, fill: near.series.colour }));
    const further = panel.series.filter(series => series.shown && series.label && series !== near.series);
    const values = further.map(series => [series.label, series.at(near.x)]).filter(([, y]) => !Number.isNaN(y));
    const lines = [
      near.series.label,
      inWords(panel.axes.x, near.x),
      inWords(panel.axes.y, near.y),
      ...values.slice(0, 6).map(([label, y]) => `${label}: ${number(y)}`),
    ];
    this.tell(lines, panel, cx, cy);
  }

  // Shows lines of text beside a place in a panel, pixels.
  tell(lines, panel, x, y) {
    this.tip.textContent = lines.filter(Boolean).join('\n');
    this.tip.classList.add('shown');
    const matrix = this.svg.getScreenCTM();
    const spot = new DOMPoint(panel.left + x, panel.top + y).matrixTransform(matrix);
    const box = this.box.getBoundingClientRect();
    const right = spot.x - box.left + 14;
    const fits = right + this.tip.offsetWidth < this.box.clientWidth;
    this.tip.style.left = `${Math.max(fits ? right : right - 28 - this.tip.offsetWidth, 0)}px`;
    this.tip.style.top = `${spot.y - box.top + 12}px`;
  }

  // Says what stands in the field under the pointer.
  showField({ panel, x, y }) {
    const [column, row] = [panel.value('x', x), panel.value('y', y)];
    const field = panel.fields.find(one => isShown(one.path) && Math.abs(one.x - column) <= 0.5 && Math.abs(one.y - row) <= 0.5);
    this.clear();
    if (!field) return;
    const lines = [inWords(panel.axes.x, field.x), inWords(panel.axes.y, field.y), field.letters];
    this.tell(lines, panel, panel.pixel('x', field.x), panel.pixel('y', field.y));
  }

  clear() {
    this.tip.classList.remove('shown');
    for (const panel of this.panels) panel.over.replaceChildren();
  }

  pressed(event) {
    if (event.button !== 0 || event.pointerType === 'touch' || event.target.closest('.key')) return;
    const at = this.place(event);
    if (!at || at.panel.fixed) return;
    this.svg.setPointerCapture(event.pointerId);
    this.drag = { ...at, pans: event.shiftKey };
    event.preventDefault();
    at.panel.hit.focus({ preventScroll: true });
  }

  dragged(event) {
    const { panel, x, y, pans } = this.drag;
    const now = this.place(event, panel);
    if (pans) {
      const [right, down] = [(now.x - x) / panel.width, (now.y - y) / panel.height];
      if (panel.axes.x.kind !== 'names') this.setRange(panel, 'x', [-right, 1 - right]);
      if (panel.axes.y.kind !== 'names') this.setRange(panel, 'y', [down, 1 + down]);
      Object.assign(this.drag, { x: now.x, y: now.y });
      return;
    }
    this.clear();
    const box = this.dragBox(now);
    panel.over.append(element('rect', { class: 'band', x: box.x[0], y: box.y[0], width: box.x[1] - box.x[0], height: box.y[1] - box.y[0] }));
  }

  // The box from where the drag began, pixels; as wide or high as the panel where it is next to flat.
  dragBox(now) {
    const { panel } = this.drag;
    const span = (direction, length) => {
      const inside = value => Math.min(Math.max(value, 0), length);
      const [low, high] = [this.drag[direction], now[direction]].map(inside).sort((a, b) => a - b);
      return high - low < 2 * LEAST_DRAG ? [0, length] : [low, high];
    };
    return { x: span('x', panel.width), y: span('y', panel.height) };
  }

  released(event) {
    if (!this.drag) return;
    const { panel, x, y, pans } = this.drag;
    const now = this.place(event, panel);
    const box = this.dragBox(now);
    this.stopDrag();
    if (pans || Math.hypot(now.x - x, now.y - y) < LEAST_DRAG) return;
    if (panel.axes.x.kind !== 'names') this.setRange(panel, 'x', box.x.map(at => at / panel.width));
    if (panel.axes.y.kind !== 'names') this.setRange(panel, 'y', box.y.map(at => 1 - at / panel.height).reverse());
  }

  stopDrag() {
    this.drag = undefined;
    this.clear();
  }

  // The wheel scrolls the page; with Ctrl or the command key it zooms.
  turned(event) {
    if (!event.ctrlKey && !event.metaKey) return;
    const at = this.place(event);
    if (!at || at.panel.fixed) return;
    event.preventDefault();
    this.zoom(at.panel, Math.exp(Math.sign(event.deltaY) * 0.2), [at.x / at.panel.width, 1 - at.y / at.panel.height]);
  }

  typed(panel, event) {
    const step = { ArrowLeft: -2, ArrowRight: 2 }[event.key];
    if (step) {
      const here = this.current?.panel === panel ? this.current.near : panel.nearest(0, panel.height / 2);
      if (!here.series) return;
      const { values } = here.series;
      const index = (here.index + step + values.length) % values.length;
      if (!Number.isNaN(values[index])) this.show(panel, { ...here, index, x: values[index], y: values[index + 1] });
    } else if (event.key === '+' || event.key === '=') this.zoom(panel, 0.5);
    else if (event.key === '-') this.zoom(panel, 2);
    else if (event.key === '0') this.reset();
    else return;
    event.preventDefault();
  }

  // All drawn values: panel, series, x, y.
  *rows() {
    const cell = (axis, value) => (axis.kind === 'names' ? axis.names[Math.round(value)] ?? value : value);
    for (const panel of this.panels) {
      const { x: across, y: up } = panel.axes;
      for (const { path, x, y, letters } of panel.fields) if (isShown(path)) yield [panel, letters, cell(across, x), cell(up, y)];
      for (const { label, values, guide, shown } of panel.series) {
        if (guide || !shown) continue;
        for (let i = 0; i < values.length; i += 2) {
          if (Number.isNaN(values[i])) continue;
          yield [panel, label, cell(across, values[i]), cell(up, values[i + 1])];
        }
      }
    }
  }

  csv() {
    const lines = [];
    let head = '';
    for (const [panel, label, x, y] of this.rows()) {
      const own = csvLine(['panel', 'series', panel.axes.x.label, panel.axes.y.label]);
      if (own !== head) lines.push(head = own);
      lines.push(csvLine([panel.title, label, x, y]));
    }
    return `${lines.join('\n')}\n`;
  }

  image() {
    const copy = this.svg.cloneNode(true);
    copy.querySelectorAll('.hit, .over').forEach(one => one.remove());
    for (const one of [copy, ...copy.querySelectorAll('*')]) {
      for (const { name } of [...one.attributes]) if (/^(data-|aria-|role|tabindex)/.test(name)) one.removeAttribute(name);
    }
    return new XMLSerializer().serializeToString(copy);
  }

  toggleTable() {
    if (this.table) {
      this.table.remove();
      this.table = undefined;
      return;
    }
    const body = html('tbody');
    let count = 0;
    for (const [panel, label, x, y] of this.rows()) {
      if (count++ >= MOST_TABLE_ROWS) continue;
      const cells = [panel.title, label, panel.axes.x.label, x, panel.axes.y.label, y];
      body.append(html('tr', {}, ...cells.map(cell => html('td', {}, typeof cell === 'number' ? number(cell, 6) : cell))));
    }
    const heads = ['panel', 'series', 'x', 'value', 'y', 'value'].map(name => html('th', { scope: 'col' }, name));
    const rest = count > MOST_TABLE_ROWS ? `The first ${MOST_TABLE_ROWS} of ${count} values; the file (CSV) has all.` : '';
    const table = html('table', { class: 'fit' }, html('thead', {}, html('tr', {}, ...heads)), body);
    const scroll = { class: 'wide values', tabindex: 0, role: 'region', 'aria-label': `Values of: ${this.heading}` };
    this.table = html('div', scroll, table, html('p', { class: 'more' }, rest));
    this.box.append(this.table);
  }
}
