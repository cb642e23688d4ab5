// Bundles exports.js with esbuild: bundle.mjs OUTPUT. Of the shaders of three.js it keeps those of the materials that are used
// and what these include, which halves the file: esbuild cannot leave out members of an object.
import { readFileSync } from 'node:fs';
import { basename, dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { build } from 'esbuild';

const kShaders = join(dirname(fileURLToPath(import.meta.url)), 'node_modules/three/src/renderers/shaders');
const kMaterials = ['meshbasic', 'background'];

const kept = new Set();
function keepChunk(name) {
  if (kept.has(name)) return;
  kept.add(name);
  keep(readFileSync(join(kShaders, 'ShaderChunk', `${name}.glsl.js`), 'utf8'));
}
function keep(text) {
  for (const [, name] of text.matchAll(/#include +<(\w+)>/g)) keepChunk(name);
}
const program = readFileSync(join(kShaders, '../webgl/WebGLProgram.js'), 'utf8');  // which puts in some of its own
for (const [, name] of program.matchAll(/ShaderChunk\[ *'(\w+)' *\]/g)) keepChunk(name);
for (const material of kMaterials) keep(readFileSync(join(kShaders, 'ShaderLib', `${material}.glsl.js`), 'utf8'));

const leaveOutShaders = {
  name: 'leave-out-shaders',
  setup(build) {
    // From the sources, not from three's own bundle, in which shaders are no files any more.
    build.onResolve({ filter: /^three$/ }, () => ({ path: join(kShaders, '../../Three.js') }));
    build.onLoad({ filter: /ShaderChunk[\\/]\w+\.glsl\.js$/ }, ({ path }) => {
      const text = readFileSync(path, 'utf8');
      if (!kept.has(basename(path, '.glsl.js'))) return { contents: "export default '';" };
      return { contents: text.replace(/\/\/.*$/gm, '').replace(/\s*\n\s*/g, '\n') };
    });
    build.onLoad({ filter: /ShaderLib[\\/]\w+\.glsl\.js$/ }, ({ path }) => {
      if (kMaterials.includes(basename(path, '.glsl.js'))) return null;
      return { contents: "export const vertex = ''; export const fragment = '';" };
    });
  },
};

await build({
  entryPoints: ['exports.js'],
  outfile: process.argv[2],
  plugins: [leaveOutShaders],
  bundle: true,
  minify: true,
  format: 'iife',
  globalName: 'THREE',
  target: 'es2020',
  charset: 'ascii',
  legalComments: 'none',
  logLevel: 'warning',
});
