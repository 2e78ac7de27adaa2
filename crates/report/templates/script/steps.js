// The steps of an explanation: waveforms and maps of residuals with the machine as it was given, calibrated, and with each
// effect that was added.

function stepSlider(place) {
  const labels = place.dataset.steps.split('|').filter(Boolean);
  if (!labels.length) return;
  const slider = html('input', { type: 'range', min: -1, max: labels.length - 1, value: -1, 'aria-label': 'Step of the explanation' });
  const shown = html('span', { role: 'status' });
  // The heading of a map that steps says where it stands.
  const maps = [...document.querySelectorAll('.plot')].filter(plot => plot.querySelector('[data-field][data-layer]'));
  const choose = () => {
    const step = +slider.value;
    for (const part of document.querySelectorAll('[data-layer]')) {
      const { layer } = part.dataset;
      part.style.display = layer === (step < 0 ? 'ends' : String(step)) ? '' : 'none';
    }
    for (const plot of maps) plot.previousElementSibling.textContent = step < 0 ? plot.dataset.title : labels[step];
    shown.textContent = step < 0 ? 'before and after' : `${step + 1} of ${labels.length}: ${labels[step]}`;
    slider.setAttribute('aria-valuetext', shown.textContent);
  };
  slider.addEventListener('input', choose);
  place.append('Figures at: ', slider, shown);
  choose();
}
