// Animation for the documents: `node test/animation.mjs REPORT.html OUT.png FROM TO FRAMES` writes an animated PNG of the viewer, between two times
// of the adapted run, s.
import { writeFileSync } from 'node:fs';
import UPNG from 'upng-js';
import { launch, open } from './browser.mjs';

/** Time of a picture, ms. */
const DELAY = 120;
/** Colours of the animation; the picture has few. */
const COLORS = 64;

const [report, out, from, to, frames] = process.argv.slice(2);
const { browser, page } = await launch({ width: 760, height: 700 });
await open(page, report);
await page.evaluate(() => document.getElementById('path').scrollIntoView());
const clip = await page.locator('.picture').boundingBox();
const pictures = [];
for (let frame = 0; frame < Number(frames); frame++) {
    const time = Number(from) + ((Number(to) - Number(from)) * frame) / (Number(frames) - 1);
    await page.locator('#scrub').evaluate((scrub, time) => {
        scrub.value = String(Number(scrub.min) + time);
        scrub.dispatchEvent(new Event('input'));
    }, time);
    await page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
    pictures.push(UPNG.decode(await page.screenshot({ clip })));
}
await browser.close();
const [{ width, height }] = pictures;
const pixels = pictures.map((picture) => UPNG.toRGBA8(picture)[0]);
const bytes = Buffer.from(UPNG.encode(pixels, width, height, COLORS, pixels.map(() => DELAY)));
writeFileSync(out, bytes);
console.log(`${out}: ${frames} pictures of ${width} x ${height}, ${bytes.length} bytes`);
