// Has three.js load STEM.glb, and compares the texture coordinates of its triangles with those of STEM.obj:
// node texture.mjs FILE.glb... NODE_PATH names the place of three. Exit: 0 all agree, 1 one does not, 77 no
// three.js.
import { existsSync, readFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { dirname, join } from 'node:path';

let three;
try {
    three = dirname(dirname(createRequire(import.meta.url).resolve('three')));
} catch {
    console.error('skip: three.js is not installed');
    process.exit(77);
}
globalThis.self = globalThis;
globalThis.ProgressEvent = class {};
const THREE = await import(join(three, 'build/three.module.js'));
const { GLTFLoader } = await import(join(three, 'examples/jsm/loaders/GLTFLoader.js'));
const { OBJLoader } = await import(join(three, 'examples/jsm/loaders/OBJLoader.js'));

// Lists the corners of triangles as [u, v] with v upward, each triangle from its lowest corner on, sorted.
function list(scene, down) {
    const triangles = [];
    scene.traverse(mesh => {
        if (!mesh.isMesh)
            return;
        const { uv } = mesh.geometry.attributes, { index } = mesh.geometry;
        const count = index ? index.count : uv.count;
        for (let i = 0; i < count; i += 3) {
            const corners = [0, 1, 2].map(k => {
                const at = index ? index.getX(i + k) : i + k;
                return [uv.getX(at), down ? 1 - uv.getY(at) : uv.getY(at)];
            });
            const names = corners.map(c => c.map(x => x.toFixed(5)).join());
            const first = names.indexOf([...names].sort()[0]);
            triangles.push([0, 1, 2].map(k => corners[(first + k) % 3]).flat());
        }
    });
    return triangles.sort((a, b) => {
        for (let i = 0; i < 6; i++)
            if (Math.abs(a[i] - b[i]) > 1e-5)
                return a[i] - b[i];
        return 0;
    });
}

async function compare(file) {
    const data = readFileSync(file), stem = file.replace(/(-quantize)?\.glb$/, '');
    const { scene } = await new GLTFLoader().parseAsync(data.buffer.slice(data.byteOffset, data.byteOffset + data.length), '');
    const is = list(scene, true), was = list(new OBJLoader().parse(readFileSync(`${stem}.obj`, 'utf8')), false);
    let wrong = is.length !== was.length ? 1 : 0;
    for (let t = 0; t < is.length && !wrong; t++)
        wrong = is[t].some((x, i) => !(Math.abs(x - was[t][i]) < 3e-5 && x >= 0 && x <= 1)) ? 1 : 0;
    console.log(`${file}: ${is.length} triangles${wrong ? ', other texture coordinates' : ''}`);
    return is.length > 0 && !wrong;
}

let good = true;
for (const file of process.argv.slice(2).filter(existsSync))
    good = await compare(file) && good;
process.exitCode = good ? 0 : 1;
