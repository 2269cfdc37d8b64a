// SPDX-License-Identifier: Apache-2.0
// node build.mjs MODULES WASM SITE: makes the page's folder. MODULES is where npm installed what package.json names.
import { cpSync, mkdirSync, readFileSync, rmSync, statSync, writeFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { dirname, join, resolve } from 'node:path';
import { fileURLToPath } from 'node:url';

const [modules, wasm, site] = process.argv.slice(2).map((path) => resolve(path));
const here = dirname(fileURLToPath(import.meta.url));
const esbuild = createRequire(join(modules, 'any.js'))('esbuild');

const common = { bundle: true, minify: true, target: 'es2022', format: 'iife', nodePaths: [modules], legalComments: 'inline', logLevel: 'warning' };

/** Gives a name of the sources what was made meanwhile. */
function made(name, loader, contents) {
  return {
    name,
    setup(build) {
      build.onResolve({ filter: new RegExp(`^${name.replace('.', '\\.')}$`) }, () => ({ path: name, namespace: name }));
      build.onLoad({ filter: /.*/, namespace: name }, () => ({ loader, contents }));
    },
  };
}

rmSync(site, { recursive: true, force: true });
mkdirSync(site, { recursive: true });
const worker = await esbuild.build({
  ...common,
  entryPoints: [join(here, 'src/simulator_worker.ts')],
  plugins: [made('capstan.wasm', 'binary', readFileSync(wasm))],
  write: false,
});
await esbuild.build({
  ...common,
  entryPoints: [join(here, 'src/main.ts')],
  plugins: [made('capstan.worker', 'text', worker.outputFiles[0].text)],
  outfile: join(site, 'console.js'),
});
await esbuild.build({ ...common, entryPoints: [join(here, 'src/style.css')], outfile: join(site, 'console.css') });
cpSync(join(here, 'src/index.html'), join(site, 'index.html'));
// Served by `capstan console` the page's policy comes as a header, which allows it to talk to that program.
const page = readFileSync(join(here, 'src/index.html'), 'utf8');
const policy = /<meta http-equiv="Content-Security-Policy"[^>]*>/g;
if (page.match(policy)?.length !== 1) throw new Error('src/index.html shall have its policy once');
writeFileSync(join(site, 'served.html'), page.replace(policy, '<meta name="capstan-served" content="">'));
cpSync(join(here, 'src/icon.svg'), join(site, 'icon.svg'));
const bytes = ['console.js', 'console.css', 'index.html', 'icon.svg'].reduce((sum, file) => sum + statSync(join(site, file)).size, 0);
console.log(`console page: ${(bytes / 1e6).toFixed(2)} MB with the simulator`);
