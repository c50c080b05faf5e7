// Has three.js load files NUMBER.glb, and compares the colours of their triangles with those of
// face_colors.sh: node face_colors.mjs FILE... NODE_PATH names the place of three. Exit: 0 all agree, 1 one
// does not, 77 no three.js.
import { readFileSync } from 'node:fs';
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

// The sRGB colour of a corner as it is drawn: the material's times the vertex's.
function colorOf(mesh, corner) {
    const { color } = mesh.geometry.attributes, own = new THREE.Color(1, 1, 1);
    if (mesh.material.vertexColors)
        own.setRGB(color.getX(corner), color.getY(corner), color.getZ(corner));
    return own.multiply(mesh.material.color).getHex();
}

async function count(file, colors) {
    const data = readFileSync(file);
    const { scene } = await new GLTFLoader().parseAsync(data.buffer.slice(data.byteOffset, data.byteOffset + data.length), '');
    let wrong = 0, triangles = 0;
    scene.traverse(mesh => {
        for (let i = 0; mesh.isMesh && i < mesh.geometry.index.count; i++) {
            const t = Math.floor(i / 3), corners = [0, 1, 2].map(k => mesh.geometry.index.getX(3 * t + k));
            const place = corners.map(v => mesh.localToWorld(new THREE.Vector3().fromBufferAttribute(mesh.geometry.attributes.position, v)));
            // the number of a triangle along the strip, by its corners
            const numbers = place.map(p => Math.round(2 * 1000 * p.x + 1000 * -p.z)), n = Math.floor(Math.min(...numbers) * colors / 600);
            const expected = (n % 250) << 16 | (255 - Math.floor(n / 250)) << 8 | 64;
            wrong += colorOf(mesh, corners[i % 3]) !== expected;
            triangles += i % 3 === 0;
        }
    });
    console.log(`${file}: ${triangles} triangles, ${wrong} corners of another colour`);
    return triangles === 600 && wrong === 0;
}

let good = true;
for (const file of process.argv.slice(2))
    good = await count(file, Number(/(\d+)\.glb$/.exec(file)[1])) && good;
process.exitCode = good ? 0 : 1;
