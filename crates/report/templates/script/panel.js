// One panel of a figure: its axes, its series with their values, and how both are drawn again.

const SVG = 'http://www.w3.org/2000/svg';
// Distances in pixels between ticks that are aimed at.
const TICK_SPACING = { x: 52, y: 34 };

function element(name, attributes = {}, ...children) {
  const made = document.createElementNS(SVG, name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  made.append(...children);
  return made;
}

function bytesOf(text) {
  return Uint8Array.from(atob(text), letter => letter.charCodeAt(0));
}

// A series: pairs of values in the order of drawing, NaN between stretches.
class Series {
  constructor(group) {
    this.group = group;
    this.key = group.dataset.series;
    this.label = this.key.slice(this.key.indexOf('|') + 1);
    this.colour = this.key.slice(0, this.key.indexOf('|'));
    this.mark = group.dataset.mark;
    this.guide = 'guide' in group.dataset;
    this.values = group.values ?? new Float32Array(bytesOf(group.dataset.values).buffer);
    this.paths = [...group.querySelectorAll('path')];
    // What stands at each point, from the middle, as it was drawn.
    this.shape = this.paths[0]?.getAttribute('d').match(/^M[^m]*(m[^M]*)/)?.[1] ?? '';
    this.rising = true;
    for (let i = 2; i < this.values.length; i += 2) {
      if (this.values[i] < this.values[i - 2]) this.rising = false;
    }
  }

  get shown() {
    return isShown(this.group);
  }

  // The vertices in pixels, NaN between stretches. Of a line that runs to the right only what is within the width, and of each
  // column of pixels the first, the lowest, the highest and the last: these draw the same (Jugel et al. 2014, M4).
  vertices(toX, toY, width) {
    const { values, mark } = this;
    const thins = this.rising && (mark === 'line' || mark === 'area');
    const out = [];
    let column = [];
    const push = ([x, y]) => out.push(x, y);
    const close = () => {
      if (column.length > 4) {
        const by = (better, a, b) => (better(column[a][1], column[b][1]) ? a : b);
        const indices = column.map((_, i) => i);
        const low = indices.reduce((best, i) => by((p, q) => p < q, i, best));
        const high = indices.reduce((best, i) => by((p, q) => p > q, i, best));
        column = [...new Set([0, low, high, column.length - 1])].sort((a, b) => a - b).map(i => column[i]);
      }
      column.forEach(push);
      column = [];
    };
    for (let i = 0; i < values.length; i += 2) {
      if (Number.isNaN(values[i])) {
        close();
        out.push(NaN, NaN);
        continue;
      }
      const vertex = [toX(values[i]), toY(values[i + 1])];
      if (!thins) {
        push(vertex);
        continue;
      }
      // The neighbours of what is within belong to the line.
      if (i + 2 < values.length && toX(values[i + 2]) < 0) continue;
      if (column.length && Math.floor(column[0][0]) !== Math.floor(vertex[0])) close();
      column.push(vertex);
      if (vertex[0] > width) break;
    }
    close();
    return out;
  }

  // Path data of the values in pixels.
  path(toX, toY, { width, height }) {
    const { mark } = this;
    const vertices = this.vertices(toX, toY, width);
    const tenths = value => Math.round(value * 10) / 10;
    let data = '';
    let first = NaN;
    let last = NaN;
    const close = () => {
      if (mark === 'area' && !Number.isNaN(last)) data += `L${last} ${height}H${first}z`;
    };
    for (let i = 0; i < vertices.length; i += 2) {
      const [x, y] = [tenths(vertices[i]), tenths(vertices[i + 1])];
      if (Number.isNaN(x)) close();
      else if (mark === 'points') data += `M${x} ${y}${this.shape}`;
      else if (mark === 'dots') data += `M${x} ${y}h0`;
      else if (Number.isNaN(last)) data += `M${first = x} ${y}`;
      else data += `L${x} ${y}`;
      last = x;
    }
    close();
    return data;
  }

  draw(toX, toY, size) {
    if (!this.paths.length) return;
    const filled = this.path(toX, toY, size);
    this.paths[0].setAttribute('d', filled);
    // An area has a line above.
    this.paths[1]?.setAttribute('d', filled.replace(/L[^L]*H[^z]*z/g, ''));
  }

  // The value at this x, from the two vertices beside it; NaN where the series has none or several.
  at(x) {
    if (!this.rising || this.mark === 'points' || this.mark === 'dots' || this.mark === 'band') return NaN;
    const { values } = this;
    for (let i = 2; i < values.length; i += 2) {
      if (values[i - 2] <= x && x <= values[i]) {
        const width = values[i] - values[i - 2];
        const share = width > 0 ? (x - values[i - 2]) / width : 0;
        return values[i - 1] + share * (values[i + 1] - values[i - 1]);
      }
    }
    return NaN;
  }
}

// Whether an element is in a layer that is shown.
function isShown(one) {
  return one.style.display !== 'none';
}

class Panel {
  constructor(svg) {
    const size = name => +svg.getAttribute(name);
    this.svg = svg;
    [this.left, this.top, this.width, this.height] = ['x', 'y', 'width', 'height'].map(size);
    this.title = svg.dataset.title;
    this.axes = { x: readAxis(svg.dataset.x), y: readAxis(svg.dataset.y) };
    this.series = [...svg.querySelectorAll('.series')].map(group => new Series(group));
    this.grid = svg.firstElementChild;
    this.under = [...svg.children].filter(child => child !== this.grid && !child.matches('.series'));
    // A map of fields is read as it stands.
    this.fields = [...svg.querySelectorAll('[data-field]')].map(path => {
      const [x, y, ...letters] = path.dataset.field.split('|');
      return { path, x: +x, y: +y, letters: letters.join('|') };
    });
    this.fixed = this.fields.length > 0;
    this.axisGroups = {};
    for (let next = svg.nextElementSibling; next && !next.matches('.plot'); next = next.nextElementSibling) {
      if (next.matches('.x-axis')) this.axisGroups.x = next;
      if (next.matches('.y-axis')) this.axisGroups.y = next;
    }
    this.over = svg.appendChild(element('g', { class: 'over' }));
    this.words = `${this.title || 'panel'}: ${this.axes.y.label} over ${this.axes.x.label}`;
  }

  pixel(direction, value) {
    const place = placeOf(this.axes[direction], value);
    const length = direction === 'x' ? this.width : this.height;
    const pixel = direction === 'x' ? place * length : (1 - place) * length;
    return Math.min(Math.max(pixel, -1e4), 1e4);
  }

  value(direction, pixel) {
    return valueAt(this.axes[direction], direction === 'x' ? pixel / this.width : 1 - pixel / this.height);
  }

  // Whether an axis can be changed between linear and logarithmic: nothing on it may be below zero.
  canBeLog(direction) {
    const axis = this.axes[direction];
    if (this.fixed || this.under.length || !['linear', 'log'].includes(axis.kind)) return false;
    const [low, high] = this.extent(direction);
    return axis.kind === 'log' || (low >= 0 && high > 0);
  }

  // Lowest and highest value, of those above zero alone if asked.
  extent(direction, positive = false) {
    let [low, high] = [Infinity, -Infinity];
    for (const { values, guide } of this.series) {
      if (guide) continue;
      for (let i = direction === 'x' ? 0 : 1; i < values.length; i += 2) {
        if (Number.isNaN(values[i]) || (positive && !(values[i] > 0))) continue;
        low = Math.min(low, values[i]);
        high = Math.max(high, values[i]);
      }
    }
    return [low, high];
  }

  setKind(direction, kind) {
    const axis = this.axes[direction];
    axis.kind = kind;
    if (kind === axis.home.kind) return Object.assign(axis, axis.home);
    let [low, high] = this.extent(direction, kind === 'log');
    if (kind === 'log') low = Math.max(low, high * 1e-8);
    if (!(high > low)) [low, high] = [low / 2, high * 2];
    return Object.assign(axis, kind === 'log' ? { low: low / 1.2, high: high * 1.2 } : { low, high });
  }

  draw() {
    const toX = value => this.pixel('x', value);
    const toY = value => this.pixel('y', value);
    for (const series of this.series) series.draw(toX, toY, this);
    const { x, y } = this.axes;
    const scale = axis => (axis.home.high - axis.home.low) / (axis.high - axis.low);
    const moved = `matrix(${scale(x)} 0 0 ${scale(y)} ${toX(x.home.low)} ${toY(y.home.high)})`;
    for (const child of this.under) child.setAttribute('transform', moved);
    const lines = [this.drawAxis('x'), this.drawAxis('y')];
    this.grid.setAttribute('d', lines.join(''));
  }

  // Draws ticks and label again where the panel has them; returns the lines of the grid.
  drawAxis(direction) {
    const across = direction === 'x';
    const length = across ? this.width : this.height;
    const { marks, label } = tickMarks(this.axes[direction], length, TICK_SPACING[direction]);
    const group = this.axisGroups[direction];
    if (group) {
      const texts = [...group.querySelectorAll('text')];
      const title = texts.pop();
      const looks = { 'font-size': 11, 'text-anchor': across ? 'middle' : 'end' };
      const [left, bottom] = [this.left, this.top + this.height];
      const spot = at => (across ? [left + at * length, bottom + 16] : [left - 7, bottom - at * length + 4]);
      texts.forEach(text => text.remove());
      for (const [at, text] of marks) {
        const [x, y] = spot(at);
        group.insertBefore(element('text', { ...looks, x, y }, text), title);
      }
      const tick = at => (across ? `M${left + at * length} ${bottom}v4` : `M${left} ${bottom - at * length}h-4`);
      group.querySelector('path').setAttribute('d', marks.map(([at]) => tick(at)).join(''));
      title.textContent = label;
    }
    const line = at => (across ? `M${at * length} 0v${this.height}` : `M0 ${(1 - at) * length}h${this.width}`);
    return marks.map(([at]) => line(at)).join('');
  }

  // The shown vertex nearest to a place in pixels, and how far it is.
  nearest(px, py) {
    let best = { distance: Infinity };
    for (const series of this.series) {
      if (!series.shown || series.guide || series.mark === 'band') continue;
      const { values } = series;
      for (let i = 0; i < values.length; i += 2) {
        if (Number.isNaN(values[i])) continue;
        const distance = Math.hypot(this.pixel('x', values[i]) - px, this.pixel('y', values[i + 1]) - py);
        if (distance < best.distance) best = { distance, series, index: i, x: values[i], y: values[i + 1] };
      }
    }
    return best;
  }
}
