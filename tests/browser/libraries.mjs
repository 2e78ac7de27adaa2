// Compares the page's own script with charting libraries: bytes, and the time of a zoom of a line of 20,000 points.
//
//     npm install --no-save plotly.js-dist-min@3.7.0 echarts@6.1.0 && node libraries.mjs

import { readFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { launch, open } from './browser.mjs';

const POINTS = 20_000;
const STEPS = 60;
const require = createRequire(import.meta.url);
const file = name => readFileSync(require.resolve(name), 'utf8');
const own = ['axis', 'panel', 'figure', 'table', 'draw', 'cases', 'select', 'steps', 'sections']
  .map(name => readFileSync(new URL(`../../crates/report/templates/script/${name}.js`, import.meta.url), 'utf8')).join('\n');
const wave = `const xs = Array.from({ length: ${POINTS} }, (_, i) => 360 * i / ${POINTS});
  const ys = xs.map((x, i) => 300 * Math.sin(x / 57.3) + 80 * Math.sin(i * 1.7) * Math.exp(-(i % 2000) / 300));`;
const ranges = `Array.from({ length: ${STEPS} }, (_, k) => [2.5 * k, 360 - 2.5 * k])`;

const candidates = {
  own: {
    script: own,
    start: `${wave} const points = xs.flatMap((x, i) => [x, ys[i]]);
      const drawn = drawFigure('x', '', [{ title: 'x', x: crankAngle(), y: axisOver('y', ys), series: [{ colour: '#0072b2', points }] }]);
      document.body.append(drawn);
      window.figure = new InteractiveFigure(drawn);`,
    zoom: `Object.assign(figure.panels[0].axes.x, { low, high }); figure.panels[0].draw();`,
  },
  plotly: {
    script: file('plotly.js-dist-min'),
    start: `${wave} await Plotly.newPlot('place', [{ x: xs, y: ys, type: 'scatter', mode: 'lines' }], { width: 960, height: 240 });`,
    zoom: `await Plotly.relayout('place', { 'xaxis.range': [low, high] });`,
  },
  'plotly, WebGL': {
    script: file('plotly.js-dist-min'),
    start: `${wave} await Plotly.newPlot('place', [{ x: xs, y: ys, type: 'scattergl', mode: 'lines' }], { width: 960, height: 240 });`,
    zoom: `await Plotly.relayout('place', { 'xaxis.range': [low, high] });`,
  },
  echarts: {
    script: file('echarts/dist/echarts.min.js'),
    start: `${wave} window.chart = echarts.init(document.getElementById('place'), null, { renderer: 'canvas', width: 960, height: 240 });
      chart.setOption({ animation: false, xAxis: { min: 0, max: 360 }, yAxis: {}, series: [{ type: 'line', showSymbol: false, data: xs.map((x, i) => [x, ys[i]]) }] });`,
    zoom: `chart.setOption({ xAxis: { min: low, max: high } });`,
  },
};

const browser = await launch();
for (const [name, { script, start, zoom }] of Object.entries(candidates)) {
  const page = await open(browser, 'about:blank');
  await page.setContent('<body><div id="place"></div></body>');
  await page.addScriptTag({ content: script });
  await page.addScriptTag({ content: `window.begin = async () => { ${start} };\nwindow.zoom = async (low, high) => { ${zoom} };` });
  const times = await page.evaluate(async ranges => {
    await window.begin();
    const times = [];
    for (const [low, high] of ranges) {
      const begun = performance.now();
      await window.zoom(low, high);
      // Layout and paint are part of it.
      await new Promise(requestAnimationFrame);
      await new Promise(done => { const { port1, port2 } = new MessageChannel(); port1.onmessage = done; port2.postMessage(0); });
      times.push(performance.now() - begun);
    }
    return times.sort((a, b) => a - b);
  }, eval(ranges)).catch(error => [NaN, error.message]);
  const at = share => times[Math.floor(share * (times.length - 1))];
  console.log(`${name}: script ${(script.length / 1e3).toFixed(0)} kB, a zoom takes ${at(0.5).toFixed?.(1)} ms in the median, ${at(0.95).toFixed?.(1)} ms at 95 %`);
}
await browser.close();
