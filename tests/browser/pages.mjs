// Works with the pages as their users do, in Chromium.
//
//     node pages.mjs GALLERY DATASET UNDERWAY PROGRAM [--update]
//
// GALLERY holds the pages of `cargo run -p crosshead-report --example gallery`, DATASET a dataset with its report, UNDERWAY one of
// which shard 0 of several is made. Both stand in the same folder, which PROGRAM serves.
// --update stores the screenshots anew.

import assert from 'node:assert/strict';
import { spawn, spawnSync } from 'node:child_process';
import { mkdirSync, readFileSync, writeFileSync, existsSync } from 'node:fs';
import { createRequire } from 'node:module';
import { basename, dirname, join, resolve } from 'node:path';
import { pathToFileURL } from 'node:url';
import { launch, open, reach } from './browser.mjs';

const [gallery, dataset, underWay, program] = process.argv.slice(2).map(path => resolve(path));
const update = process.argv.includes('--update');
const axe = readFileSync(createRequire(import.meta.url).resolve('axe-core/axe.min.js'), 'utf8');
const PAGES = ['grid', 'random', 'calibration', 'chaos'];
const WIDTHS = [[360, 720], [1280, 800], [2560, 1440]];
// Largest mean difference of a screenshot from the stored one, of 255: fonts differ from one machine to the next.
const TOLERANCE = 10;

const url = (folder, name) => pathToFileURL(join(folder, `${name}.html`)).href;
const browser = await launch();
let failures = 0;

async function check(name, test) {
  const errors = [];
  try {
    await test(errors);
    assert.deepEqual(errors, [], 'the console has errors');
    console.log(`ok      ${name}`);
  } catch (error) {
    failures += 1;
    console.log(`FAILED  ${name}\n${error.stack ?? error}`);
  }
}

/** What a series of the first figure on the page draws now. */
const drawn = page => page.evaluate(() => document.querySelector('figure .series path').getAttribute('d'));

await check('a value stands under the cursor, in words and in the panels of the same axis', async errors => {
  const page = await open(browser, url(gallery, 'grid'), {}, errors);
  await reach(page, 'figure');
  const box = await page.locator('figure .plot').first().boundingBox();
  await page.mouse.move(box.x + box.width / 3, box.y + box.height / 2);
  const tip = page.locator('figure .tip.shown').first();
  assert.match(await tip.textContent(), /crank angle [\d.]+°\s+acceleration −?[\d.]+ m\/s²/);
});

await check('dragging zooms, a double click shows all again, keys do both', async errors => {
  const page = await open(browser, url(gallery, 'grid'), {}, errors);
  await reach(page, 'figure');
  const before = await drawn(page);
  const box = await page.locator('figure .plot').first().boundingBox();
  await page.mouse.move(box.x + 60, box.y + 40);
  await page.mouse.down();
  await page.mouse.move(box.x + 160, box.y + 110, { steps: 4 });
  await page.mouse.up();
  await page.waitForFunction(old => document.querySelector('figure .series path').getAttribute('d') !== old, before);
  const zoomed = await drawn(page);
  await page.mouse.dblclick(box.x + 100, box.y + 60);
  await page.waitForFunction(old => document.querySelector('figure .series path').getAttribute('d') !== old, zoomed);
  const ticks = () => page.evaluate(() => document.querySelector('figure .x-axis').textContent);
  const all = await ticks();
  await page.locator('figure .hit').first().focus();
  await page.keyboard.press('+');
  await page.waitForFunction(old => document.querySelector('figure .x-axis').textContent !== old, all);
  await page.keyboard.press('0');
  await page.waitForFunction(old => document.querySelector('figure .x-axis').textContent === old, all);
});

await check('a click in the legend hides a series, the axis turns logarithmic, orders get cursors', async errors => {
  const page = await open(browser, url(gallery, 'grid'), {}, errors);
  await reach(page, 'figure:has(.key)');
  const key = page.locator('.key').first();
  await key.click();
  assert.equal(await key.getAttribute('aria-checked'), 'false');
  const hidden = await page.evaluate(() => [...document.querySelectorAll('figure:has(.key) .series')].filter(one => one.style.display === 'none').length);
  assert.ok(hidden > 0);
  await reach(page, 'figure');
  await page.locator('figure select').first().selectOption('1');
  await page.waitForSelector('figure .orders path', { state: 'attached' });
  const log = page.locator('figure button', { hasText: 'log y' }).first();
  const before = await log.getAttribute('aria-pressed');
  await log.click();
  assert.notEqual(await log.getAttribute('aria-pressed'), before);
});

await check('values are a table, a CSV file and an SVG file', async errors => {
  const page = await open(browser, url(gallery, 'grid'), {}, errors);
  await reach(page, 'figure');
  const figure = page.locator('figure').first();
  await figure.getByRole('button', { name: 'Table' }).click();
  assert.ok(await figure.locator('table tbody tr').count() > 100);
  const file = async name => {
    const [download] = await Promise.all([page.waitForEvent('download'), figure.getByRole('button', { name }).click()]);
    return readFileSync(await download.path(), 'utf8');
  };
  const csv = (await file('CSV')).trim().split('\n');
  assert.match(csv[0], /^panel,series,crank angle \(°\),acceleration \(m\/s²\)$/);
  assert.ok(csv.slice(1, 50).every(line => /,-?[\d.]+(e-?\d+)?,-?[\d.]+(e-?\d+)?$/.test(line)), csv[1]);
  const svg = await file('SVG');
  assert.ok(svg.startsWith('<svg') && !svg.includes('data-values'));
});

await check('tables sort and find', async errors => {
  const page = await open(browser, url(dataset, 'report'), {}, errors);
  const table = page.locator('#ranking table');
  await table.scrollIntoViewIfNeeded();
  const first = () => table.locator('tbody tr').first().locator('td').nth(1).textContent();
  await table.getByRole('button', { name: /mutual information/ }).click();
  const lowest = parseFloat(await first());
  await table.getByRole('button', { name: /mutual information/ }).click();
  assert.ok(parseFloat(await first()) > lowest);
});

await check('cases filter, sort and open; the address is the case', async errors => {
  const page = await open(browser, url(dataset, 'report'), {}, errors);
  const cases = page.locator('#case-table');
  const all = parseInt(await cases.locator('[role=status]').first().textContent(), 10);
  await cases.getByLabel('class').selectOption({ index: 2 });
  const some = parseInt(await cases.locator('[role=status]').first().textContent(), 10);
  assert.ok(some > 0 && some < all, `${some} of ${all}`);
  const link = cases.locator('tbody a').nth(3);
  const name = await link.textContent();
  await link.click();
  await page.waitForFunction(wanted => document.querySelector('.case h3')?.textContent.startsWith(wanted), name);
  assert.equal(new URL(page.url()).hash, `#${name}`);
  const titles = await cases.locator('.case figure .plot').evaluateAll(plots => plots.map(plot => plot.dataset.title));
  for (const wanted of [/over the crank angle/, /Order spectrum/, /Envelope spectrum/, /p-V card/, /Portrait/]) {
    assert.ok(titles.some(title => wanted.test(title)), `${wanted} in ${titles}`);
  }
  assert.match(await cases.locator('.case code').textContent(), new RegExp(`--case ${name}$`));
  const again = await open(browser, `${url(dataset, 'report')}#${name}`, {}, errors);
  await again.waitForFunction(wanted => document.querySelector('.case h3')?.textContent.startsWith(wanted), name);
});

await check('figures can be chosen by class', async errors => {
  const page = await open(browser, url(gallery, 'grid'), {}, errors);
  const select = page.getByLabel('Figures: class');
  await select.selectOption({ index: 1 });
  const wanted = await select.inputValue();
  const shown = await page.evaluate(() => [...document.querySelectorAll('main figure[id]')].filter(one => !one.hidden).map(one => one.dataset.class));
  assert.ok(shown.includes(wanted) && shown.every(one => one === '' || one === wanted));
});

await check('a bifurcation diagram shows the motion at the value under the cursor', async errors => {
  const page = await open(browser, url(gallery, 'chaos'), {}, errors);
  await reach(page, 'figure:has(> .sections)');
  const box = await page.locator('figure:has(> .sections) .plot').first().boundingBox();
  await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
  assert.match(await page.locator('figure figure figcaption').first().textContent(), /revolutions rising/);
});

await check('the theme switches to dark', async errors => {
  const page = await open(browser, url(gallery, 'random'), {}, errors);
  const background = () => page.evaluate(() => getComputedStyle(document.documentElement).backgroundColor);
  assert.equal(await background(), 'rgb(255, 255, 255)');
  await page.locator('.theme').click();
  await page.locator('.theme').click();
  assert.equal(await background(), 'rgb(23, 23, 23)');
});

await check('served: a case has all figures, a sweep under way moves on', async errors => {
  const server = spawn(program, ['serve', dirname(dataset), '--port', '0'], { stdio: ['ignore', 'pipe', 'ignore'] });
  try {
    const address = await new Promise((found, failed) => {
      server.stdout.on('data', text => found(String(text).trim()));
      server.on('exit', status => failed(new Error(`the server ended with ${status}`)));
    });
    const index = await open(browser, address, {}, errors);
    await index.getByRole('link', { name: basename(underWay) }).click();
    await index.waitForURL(/progress\.html$/);
    const done = () => index.evaluate(() => document.querySelector('progress').value);
    const before = await done();
    const cases = await index.evaluate(() => document.querySelector('progress').max);
    assert.ok(before > 0 && before < cases, `${before} of ${cases}`);
    spawnSync(program, ['sweep', 'shard', underWay, '--index', '1']);
    await index.waitForFunction(old => document.querySelector('progress').value > old, before);

    const page = await open(browser, `${address}${basename(dataset)}/report.html`, {}, errors);
    await page.locator('#case-table tbody a').first().click();
    await page.waitForFunction(() => [...document.querySelectorAll('.case h3')].some(one => one.textContent === 'Motion in the joints'));
    const headings = await page.locator('.case figure h3').allTextContents();
    assert.ok(!headings.includes('Recording') && headings.includes('p-V cards'), headings.join());
    await page.waitForFunction(() => [...document.querySelectorAll('.case figure')].every(one => one.live));
  } finally {
    server.kill();
  }
});

for (const [folder, name] of [...PAGES.map(name => [gallery, name]), [dataset, 'report'], [dataset, 'features']]) {
  for (const dark of [false, true]) {
    await check(`axe finds nothing serious: ${name}, ${dark ? 'dark' : 'light'}`, async errors => {
      const page = await open(browser, url(folder, name), { dark }, errors);
      await page.evaluate(async () => {
        const [link] = document.querySelectorAll('#case-table tbody a');
        link?.click();
        for (const figure of document.querySelectorAll('figure')) {
          figure.scrollIntoView();
          await new Promise(requestAnimationFrame);
        }
        await new Promise(done => setTimeout(done, 200));
      });
      await page.evaluate(axe);
      const found = await page.evaluate(() => window.axe.run(document, { resultTypes: ['violations'] }));
      const serious = found.violations.filter(one => ['serious', 'critical'].includes(one.impact));
      assert.deepEqual(serious.map(one => `${one.id}: ${one.nodes.slice(0, 3).map(node => node.html.slice(0, 160))}`), []);
    });
  }
}

await check('no page is wider than its window', async errors => {
  for (const name of PAGES) {
    const page = await open(browser, url(gallery, name), { width: 360 }, errors);
    const width = await page.evaluate(() => document.documentElement.scrollWidth);
    assert.ok(width <= 360, `${name}: ${width}`);
  }
});

// The mean difference of two images in a sixteenth of their size, of 255.
async function difference(images) {
  const page = await open(browser, 'about:blank');
  return page.evaluate(async sources => {
    const pixels = await Promise.all(sources.map(async source => {
      const image = new Image();
      image.src = source;
      await image.decode();
      const canvas = document.createElement('canvas');
      [canvas.width, canvas.height] = [image.width / 16, image.height / 16].map(Math.ceil);
      const context = canvas.getContext('2d');
      context.drawImage(image, 0, 0, canvas.width, canvas.height);
      return context.getImageData(0, 0, canvas.width, canvas.height).data;
    }));
    const [a, b] = pixels;
    if (a.length !== b.length) return Infinity;
    return a.reduce((sum, value, i) => sum + Math.abs(value - b[i]), 0) / a.length;
  }, images.map(image => `data:image/png;base64,${image.toString('base64')}`));
}

const stored = new URL('screenshots/', import.meta.url).pathname;
mkdirSync(stored, { recursive: true });
for (const name of PAGES) {
  for (const [width, height] of WIDTHS) {
    await check(`${name} looks as before at ${width} px`, async errors => {
      const page = await open(browser, url(gallery, name), { width, height }, errors);
      await reach(page, 'figure');
      await page.evaluate(() => document.querySelector('figure').scrollIntoView());
      const image = await page.screenshot();
      const path = join(stored, `${name}-${width}.png`);
      if (update || !existsSync(path)) return writeFileSync(path, image);
      const off = await difference([readFileSync(path), image]);
      assert.ok(off <= TOLERANCE, `differs by ${off.toFixed(1)} of 255`);
    });
  }
}

await check('the page of a dataset opens and answers fast', async errors => {
  const page = await open(browser, url(dataset, 'report'), {}, errors);
  const bytes = readFileSync(join(dataset, 'report.html')).length;
  const paint = await page.evaluate(() => performance.getEntriesByName('first-contentful-paint')[0].startTime);
  const timed = action => page.evaluate(async body => {
    const start = performance.now();
    await new Function(`return (async () => { ${body} })()`)();
    await new Promise(requestAnimationFrame);
    return performance.now() - start;
  }, action);
  const filter = index => `const select = document.querySelector('#case-table select'); select.selectedIndex = ${index}; select.dispatchEvent(new Event('change'));`;
  const times = {
    filter: await timed(filter(2)),
    'sort by a number': await timed("[...document.querySelectorAll('#case-table .sort')].at(-1).click();"),
    'open a case': await timed("location.hash = document.querySelector('#case-table tbody a').getAttribute('href'); await new Promise(done => addEventListener('hashchange', done, { once: true }));"),
  };
  await reach(page, 'main > section figure[id]');
  times.zoom = await timed("document.querySelector('main > section figure[id] .tools button').click(); await new Promise(requestAnimationFrame);");
  const words = Object.entries(times).map(([name, ms]) => `${name} ${ms.toFixed(0)} ms`).join(', ');
  console.log(`        ${(bytes / 1e6).toFixed(2)} MB, first paint ${paint.toFixed(0)} ms, ${words}`);
  assert.ok(bytes < 6e6);
});

await browser.close();
process.exit(failures ? 1 : 0);
