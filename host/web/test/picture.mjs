// Picture for the documents: `node test/picture.mjs REPORT.html OUT.png SECONDS`, side by side at a time of the adapted run, or
// `node test/picture.mjs REPORT.html OUT.png SELECTOR`, the first element of a selector.
import { launch, open } from './browser.mjs';

const [report, out, what] = process.argv.slice(2);
const isElement = Number.isNaN(Number(what));
const { browser, page } = await launch({ width: isElement ? 800 : 1200, height: 880 });
await open(page, report);
if (isElement) {
    await page.locator(what).first().screenshot({ path: out });
} else {
    await page.locator('[data-show=both]').click();
    await page.locator('#scrub').evaluate((scrub, time) => {
        scrub.value = String(Number(scrub.min) + Number(time));
        scrub.dispatchEvent(new Event('input'));
    }, what);
    await page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
    await page.screenshot({ path: out });
}
await browser.close();
