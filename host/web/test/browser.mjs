// A headless browser with WebGL but without a graphics card, and a report opened in it.
import { existsSync } from 'node:fs';
import { pathToFileURL } from 'node:url';
import { chromium } from 'playwright-core';

const BROWSERS = ['chromium', 'chromium-browser', 'google-chrome'].map((name) => `/usr/bin/${name}`);

export async function launch(viewport) {
    const args = ['--no-sandbox', '--use-angle=swiftshader', '--enable-unsafe-swiftshader'];
    const browser = await chromium.launch({ executablePath: BROWSERS.find(existsSync), args });
    return { browser, page: await browser.newPage({ viewport }) };
}

export async function open(page, report) {
    await page.goto(pathToFileURL(report).href);
    await page.waitForFunction(() => document.documentElement.dataset.viewer === 'ready', null, { timeout: 60_000 });
}
