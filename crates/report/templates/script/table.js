// Tables sort by a click on a heading, and longer ones have a field to look for rows.

const LONG_TABLE = 8;

// What a cell is sorted by: its number if it begins with one, else its text.
function sortKey(text) {
  const value = parseFloat(text.replace(/[\u00a0\u202f]/g, '').replace('−', '-'));
  return Number.isNaN(value) ? text.toLowerCase() : value;
}

function compareKeys(a, b) {
  if (typeof a === typeof b) return a < b ? -1 : Number(a > b);
  return typeof a === 'number' ? -1 : 1;
}

// A heading that sorts: `sort` gets the direction, 1 for the lowest first.
function sortingHead(head, sort) {
  const button = html('button', { type: 'button', class: 'sort' });
  button.append(...head.childNodes);
  head.append(button);
  button.addEventListener('click', () => {
    const direction = head.getAttribute('aria-sort') === 'ascending' ? -1 : 1;
    head.parentElement.querySelectorAll('th').forEach(other => other.removeAttribute('aria-sort'));
    head.setAttribute('aria-sort', direction > 0 ? 'ascending' : 'descending');
    sort(direction);
  });
}

function sortable(table) {
  const scroll = table.closest('.wide');
  if (table.closest('#case-table')) return;
  scroll?.setAttribute('tabindex', 0);
  const body = table.tBodies[0];
  if (!body || body.rows.length < LONG_TABLE) return;
  [...table.tHead.rows[0].cells].forEach((head, column) => sortingHead(head, direction => {
    const key = row => sortKey(row.cells[column]?.textContent ?? '');
    body.append(...[...body.rows].sort((a, b) => direction * compareKeys(key(a), key(b))));
  }));
  const find = html('input', { type: 'search', placeholder: 'find', 'aria-label': 'Show the rows that contain' });
  find.addEventListener('input', () => {
    const wanted = find.value.toLowerCase();
    for (const row of body.rows) row.hidden = !row.textContent.toLowerCase().includes(wanted);
  });
  (scroll ?? table).before(html('p', { class: 'find' }, find));
}
