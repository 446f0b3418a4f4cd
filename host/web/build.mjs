// Bundles the viewer: `npm ci && npm run build` writes viewer.js.zlib (compressed), viewer.css and start.js, or the same into the folder that is named.
import { readFileSync, rmSync, writeFileSync } from 'node:fs';
import { resolve } from 'node:path';
import { deflateSync } from 'node:zlib';

import { build } from 'esbuild';

const notice = `/*! Viewer of arcfeed, MIT OR Apache-2.0. It contains three.js (Copyright 2010-2026 Three.js Authors) and uPlot
(Copyright 2022 Leon Sorokin), both under the MIT licence:
Permission is hereby granted, free of charge, to any person obtaining a copy of this software and associated documentation files
(the "Software"), to deal in the Software without restriction, including without limitation the rights to use, copy, modify, merge,
publish, distribute, sublicense, and/or sell copies of the Software, and to permit persons to whom the Software is furnished to do
so, subject to the following conditions: The above copyright notice and this permission notice shall be included in all copies or
substantial portions of the Software. THE SOFTWARE IS PROVIDED "AS IS", WITHOUT WARRANTY OF ANY KIND, EXPRESS OR IMPLIED, INCLUDING
BUT NOT LIMITED TO THE WARRANTIES OF MERCHANTABILITY, FITNESS FOR A PARTICULAR PURPOSE AND NONINFRINGEMENT. IN NO EVENT SHALL THE
AUTHORS OR COPYRIGHT HOLDERS BE LIABLE FOR ANY CLAIM, DAMAGES OR OTHER LIABILITY, WHETHER IN AN ACTION OF CONTRACT, TORT OR
OTHERWISE, ARISING FROM, OUT OF OR IN CONNECTION WITH THE SOFTWARE OR THE USE OR OTHER DEALINGS IN THE SOFTWARE. */`;

const folder = resolve(import.meta.dirname, process.argv[2] ?? '.');
await build({
    absWorkingDir: import.meta.dirname,
    entryPoints: { viewer: 'src/main.ts', start: 'src/start.ts' },
    outdir: folder,
    bundle: true,
    minify: true,
    format: 'iife',
    target: 'es2022',
    charset: 'ascii',
    legalComments: 'none',
    banner: { js: notice },
});
const bundle = resolve(folder, 'viewer.js');
writeFileSync(`${bundle}.zlib`, deflateSync(readFileSync(bundle), { level: 9 }));
rmSync(bundle);
