// Selectors for the figures of a page: by class, sensor and operating point, where figures differ in these.

const SELECTED = [['class', 'class'], ['sensor', 'channel'], ['point', 'operating point']];

function figureSelectors() {
  const figures = [...document.querySelectorAll('main figure[id]')];
  const choices = SELECTED.map(([key, name]) => {
    const values = [...new Set(figures.map(figure => figure.dataset[key]).filter(Boolean))];
    return values.length > 1 ? { key, name, values } : undefined;
  });
  const selects = choices.filter(Boolean).map(({ key, name, values }) => {
    const select = html('select', { 'aria-label': `Figures: ${name}` }, html('option', { value: '' }, `${name}: all`));
    select.append(...values.map(value => html('option', { value }, value)));
    return { key, select };
  });
  if (!selects.length) return;
  const counted = html('span', { role: 'status' });
  const choose = () => {
    // What shows several of a kind stays.
    const fits = figure => selects.every(({ key, select }) => !select.value || !figure.dataset[key] || figure.dataset[key] === select.value);
    for (const figure of figures) figure.hidden = !fits(figure);
    const shown = figures.filter(figure => !figure.hidden).length;
    counted.textContent = shown < figures.length ? `${shown} of ${figures.length} figures` : '';
  };
  const bar = html('p', { class: 'tools select' }, 'Figures: ', ...selects.map(({ select }) => select), counted);
  selects.forEach(({ select }) => select.addEventListener('change', choose));
  document.querySelector('main').prepend(bar);
}
