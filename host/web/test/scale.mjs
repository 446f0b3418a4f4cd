// Times of reports of different sizes in one browser: `node test/scale.mjs REPORT.html ...` prints, for each, the seconds until the first picture
// and until the viewer is ready, and the pictures a second while the slider moves and after each step of it, and the ratios to the first as JSON.
import { launch, open } from './browser.mjs';

const STEPS = 24;
const reports = process.argv.slice(2);
const { browser } = await launch({ width: 1200, height: 900 });

const median = (values) => values.sort((a, b) => a - b)[values.length >> 1];

/** Times of pictures while the slider goes through the run, each complete, ms. */
const scrub = (page) => page.evaluate(async (steps) => {
    const [slider, path] = ['scrub', 'path'].map((id) => document.getElementById(id));
    const gl = path.getContext('webgl2');
    const pixel = new Uint8Array(4);
    const frame = () => new Promise((done) => requestAnimationFrame(done));
    const times = [];
    for (let step = 0; step < steps; step++) {
        const began = performance.now();
        slider.value = String(Number(slider.min) + ((Number(slider.max) - Number(slider.min)) * (step + 0.5)) / steps);
        slider.dispatchEvent(new Event('input'));
        await frame();
        await frame();
        // The picture is complete as soon as it can be read.
        gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel);
        times.push(performance.now() - began);
    }
    return times;
}, STEPS);

const opened = [];
const firsts = [];
const frames = [];
// By turns, so that what else the computer does slows all of them.
for (let round = 0; round < 2; round++) {
    for (const [index, report] of reports.entries()) {
        const page = await browser.newPage({ viewport: { width: 1200, height: 900 } });
        const began = performance.now();
        await open(page, report);
        (opened[index] ??= []).push(performance.now() - began);
        (firsts[index] ??= []).push(await page.evaluate(() => performance.getEntriesByName('picture')[0].startTime));
        (frames[index] ??= []).push(...(await scrub(page)).slice(2));
        await page.close();
    }
}
await browser.close();
const figures = reports.map((report, index) => ({ report, first_ms: median(firsts[index]), ready_ms: median(opened[index]), frame_ms: median(frames[index]) }));
for (const { report, first_ms, ready_ms, frame_ms } of figures) {
    console.log(`${report}: first picture after ${(first_ms / 1e3).toFixed(2)} s, ready after ${(ready_ms / 1e3).toFixed(2)} s, ${(1e3 / frame_ms).toFixed(1)} pictures a second`);
}
console.log(JSON.stringify(figures.map(({ frame_ms }) => frame_ms / figures[0].frame_ms)));
