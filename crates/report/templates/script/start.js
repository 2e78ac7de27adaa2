// What the page does when it has been read: figures become interactive when they come near the window.

function makeLive(figure) {
  if (figure.querySelector('.plot')) figure.live ??= new InteractiveFigure(figure);
}

function start() {
  const seen = new IntersectionObserver(entries => {
    for (const { isIntersecting, target } of entries) {
      if (!isIntersecting) continue;
      seen.unobserve(target);
      makeLive(target);
    }
  }, { rootMargin: '400px' });
  document.querySelectorAll('figure').forEach(figure => seen.observe(figure));
  const cases = document.getElementById('case-data');
  if (cases) new CaseTable(JSON.parse(cases.textContent), document.getElementById('case-table'));
  document.querySelectorAll('main table').forEach(sortable);
  figureSelectors();
  const steps = document.getElementById('steps');
  if (steps) stepSlider(steps);
  document.body.prepend(themeSwitch());
}

// Light, dark, or as the system has it.
function themeSwitch() {
  const themes = ['auto', 'light', 'dark'];
  const stored = () => {
    try { return localStorage.getItem('crosshead-theme') ?? 'auto'; } catch { return 'auto'; }
  };
  const button = html('button', { type: 'button', class: 'theme', title: 'Light or dark page' });
  const apply = theme => {
    document.documentElement.dataset.theme = theme;
    button.textContent = `theme: ${theme}`;
    try { localStorage.setItem('crosshead-theme', theme); } catch { /* A page from a file may have no storage. */ }
  };
  button.addEventListener('click', () => {
    const now = document.documentElement.dataset.theme;
    apply(themes[(themes.indexOf(now) + 1) % themes.length]);
  });
  apply(themes.includes(stored()) ? stored() : 'auto');
  return button;
}

start();
