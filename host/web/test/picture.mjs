// Picture for the documents: `node test/picture.mjs REPORT.html OUT.png SECONDS`, side by side at a time of the adapted run.
import { launch, open } from './browser.mjs';

const [report, out, time] = process.argv.slice(2);
const { browser, page } = await launch({ width: 1200, height: 880 });
await open(page, report);
await page.locator('[data-show=both]').click();
await page.locator('#scrub').evaluate((scrub, time) => {
    scrub.value = String(Number(scrub.min) + Number(time));
    scrub.dispatchEvent(new Event('input'));
}, time);
await page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
await page.screenshot({ path: out });
await browser.close();
