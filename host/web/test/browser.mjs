// A headless browser with WebGL but without a graphics card, a report opened in it, and checks of any page.
import assert from 'node:assert/strict';
import { existsSync, readFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { pathToFileURL } from 'node:url';
import { chromium } from 'playwright-core';

// A headless shell starts in a third of the processor time of a whole browser.
const BROWSERS = ['chromium-headless-shell', 'chromium', 'chromium-browser', 'google-chrome'].map((name) => `/usr/bin/${name}`);

export async function launch(viewport) {
    // SwiftShader draws WebGL alone: if it drew the rest of a page too, that would take half as much processor time again.
    const args = ['--no-sandbox', '--use-angle=swiftshader-webgl', '--enable-unsafe-swiftshader'];
    const browser = await chromium.launch({ executablePath: BROWSERS.find(existsSync), args });
    return { browser, page: await browser.newPage({ viewport }) };
}

export async function open(page, report) {
    await page.goto(pathToFileURL(report).href);
    await page.waitForFunction(() => document.documentElement.dataset.viewer === 'ready', null, { timeout: 60_000 });
}

// A page without a graphics card reads its WebGL picture back, of which the browser warns.
const READ_BACK = 'GPU stall due to ReadPixels';

/** Messages on the console and requests of a page, from now on, without the warning of a picture that is read back. */
export function watch(page) {
    const [messages, requests] = [[], []];
    page.on('console', (message) => {
        if (!message.text().includes(READ_BACK)) messages.push(message.text());
    });
    page.on('pageerror', (error) => messages.push(error.message));
    page.on('request', (request) => requests.push(request.url()));
    return { messages, requests };
}

/** axe-core finds nothing serious in the page as it is. */
export async function accessible(page, name) {
    await page.evaluate(readFileSync(createRequire(import.meta.url).resolve('axe-core/axe.min.js'), 'utf8'));
    const { violations, passes } = await page.evaluate(() => globalThis.axe.run({ iframes: false }));
    const serious = violations.filter(({ impact }) => impact === 'serious' || impact === 'critical');
    console.log(`axe-core, ${name}: ${passes.length} rules passed, ${violations.length} findings, ${serious.length} serious`);
    const lines = serious.map(({ id, nodes }) => `${id}: ${nodes.map(({ html }) => html.slice(0, 120)).join(' | ')}`);
    assert.deepEqual(lines, []);
}

/** What a function of the picture's bytes (RGBA), its width and its element returns; it runs in the page. */
export const inPicture = (page, measure) => page.evaluate(`(() => {
    const path = document.getElementById('path');
    const copy = document.createElement('canvas');
    [copy.width, copy.height] = [path.width, path.height];
    const context = copy.getContext('2d');
    context.drawImage(path, 0, 0);
    return (${measure})(context.getImageData(0, 0, copy.width, copy.height).data, copy.width, path);
})()`);

/** Pixels of the picture that are not of its most frequent colour, and the number of colours, with few steps each. */
export async function pixels(page) {
    await page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
    const counts = await inPicture(page, (data) => {
        const counts = {};
        for (let at = 0; at < data.length; at += 4) {
            const color = [data[at] >> 4, data[at + 1] >> 4, data[at + 2] >> 4].join();
            counts[color] = (counts[color] ?? 0) + 1;
        }
        return counts;
    });
    const background = Math.max(...Object.values(counts));
    const all = Object.values(counts).reduce((a, b) => a + b, 0);
    return { counts, drawn: all - background, colors: Object.keys(counts).length };
}
