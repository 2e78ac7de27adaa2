// Asks for the content of the page again and again, and fills in what has changed: texts by `data-key`, rows by `data-id`.
(() => {
'use strict';
const LEAST_PAUSE_MS = 3000;

function fill(element, texts) {
  for (const cell of element.querySelectorAll('[data-key]')) {
    const text = texts[cell.dataset.key];
    if (text !== undefined && cell.textContent !== text) cell.textContent = text;
  }
  for (const part of element.querySelectorAll('[data-if]')) part.hidden = texts[part.dataset.if] === '';
}

function fillRows(body, row, rows) {
  const known = new Map([...body.rows].map(one => [one.dataset.id, one]));
  for (const { id, href, texts } of rows) {
    let one = known.get(id);
    if (!one) {
      one = row.content.querySelector('tr').cloneNode(true);
      one.dataset.id = id;
      body.append(one);
    }
    known.delete(id);
    const link = one.querySelector('a');
    if (link && href) link.href = href;
    fill(one, texts);
  }
  for (const gone of known.values()) gone.remove();
}

function show(content) {
  const main = document.querySelector('main');
  fill(document, content.shown.texts);
  fillRows(main.querySelector('table.live').tBodies[0], main.querySelector('template'), content.shown.rows);
  const bar = document.querySelector('progress');
  if (bar) [bar.max, bar.value] = [content.cases, content.cases_done];
}

async function ask() {
  const begun = performance.now();
  const silent = document.querySelector('[data-silent]');
  try {
    const answer = await fetch(document.querySelector('main').dataset.source, { cache: 'no-store' });
    if (!answer.ok) throw new Error(await answer.text());
    show(await answer.json());
    silent.textContent = '';
  } catch (error) {
    silent.textContent = `Not up to date: ${error.message}`;
  }
  // What takes long to answer is asked for less often.
  setTimeout(ask, Math.max(LEAST_PAUSE_MS, 5 * (performance.now() - begun)));
}

setTimeout(ask, LEAST_PAUSE_MS);
})();
