// A browser for the tests, and pages that must not complain.

import { existsSync } from 'node:fs';
import { chromium } from 'playwright-core';

const PROGRAMS = ['/usr/bin/chromium', '/usr/bin/chromium-browser', '/usr/bin/google-chrome'];

/** The browser program, if there is one: CHROMIUM, or where Debian and its like put it. */
export function program() {
  return [process.env.CHROMIUM, ...PROGRAMS].find(path => path && existsSync(path));
}

export async function launch() {
  // A container has neither a sandbox of its own nor a graphics card.
  return chromium.launch({ executablePath: program(), args: ['--no-sandbox', '--disable-gpu', '--force-color-profile=srgb'] });
}

/** Opens a page; what it writes to the console as an error, and what it throws, is added to `errors`. */
export async function open(browser, url, { width = 1280, height = 800, dark = false } = {}, errors = []) {
  const context = await browser.newContext({
    viewport: { width, height },
    colorScheme: dark ? 'dark' : 'light',
    acceptDownloads: true,
    reducedMotion: 'reduce',
  });
  const page = await context.newPage();
  page.on('console', message => { if (message.type() === 'error') errors.push(message.text()); });
  page.on('pageerror', error => errors.push(String(error)));
  await page.goto(url);
  return page;
}

/** Scrolls to an element and waits until its figure, if it is one, works. */
export async function reach(page, selector) {
  await page.locator(selector).first().scrollIntoViewIfNeeded();
  await page.waitForFunction(wanted => {
    const found = document.querySelector(wanted);
    return !found.querySelector?.('.plot') || Boolean(found.closest('figure')?.live);
  }, selector);
}
