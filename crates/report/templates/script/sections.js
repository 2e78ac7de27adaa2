// Beside a bifurcation diagram: the motion at the value under the cursor, once a revolution.

class Sections {
  constructor(figure) {
    this.sections = JSON.parse(figure.box.querySelector('.sections').textContent);
    const all = this.sections.flatMap(({ up, down }) => [...up, ...down]);
    const [x, y] = [0, 1].map(i => axisOver(['velocity (m/s)', 'acceleration (m/s²)'][i], all.map(point => point[i])));
    const of = (label, colour) => ({ label, colour, mark: 'points', points: [] });
    const drawn = drawFigure('The motion at the value under the cursor', '', [
      { title: '', x, y, series: [of('rising', CASE_CURVE), of('falling', CASE_PRESSURE)] },
    ]);
    figure.box.append(drawn);
    makeLive(drawn);
    [this.panel] = drawn.live.panels;
    this.caption = drawn.querySelector('figcaption');
    this.label = figure.panels[0].axes.x;
    this.show(this.sections[0].value);
  }

  // Shows the section nearest to a value of the parameter.
  show(value) {
    const far = section => Math.abs(section.value - value);
    const nearest = this.sections.reduce((best, section) => (far(section) < far(best) ? section : best));
    [nearest.up, nearest.down].forEach((points, i) => { this.panel.series[i].values = Float32Array.from(points.flat()); });
    this.panel.draw();
    this.caption.textContent = `Velocity and acceleration when the crank passes angle 0, ${inWords(this.label, nearest.value)}: `
      + `${nearest.up.length} revolutions rising, ${nearest.down.length} falling. One dot is a motion that repeats every revolution.`;
  }
}
