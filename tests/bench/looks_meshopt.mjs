#!/usr/bin/env node
// How alike meshes with few triangles look to a full one: ours, with a baked normal map and without, beside those
// of meshoptimizer in WebAssembly (npm install meshoptimizer@1), by `cubewright check --looks`.
//
//   MESHOPTIMIZER=node_modules/meshoptimizer node looks_meshopt.mjs BIN_FOLDER FULL.ply [TRIANGLES...]
//
// FULL.ply is as `extract` writes it: binary, with normals. meshoptimizer runs with its defaults and without a
// limit of its error, by positions alone, and with normals as attributes of weight 0.5; kept vertices keep their
// normals. Prints a table of Markdown: PSNR in dB and mean CIEDE2000 over 8 views.
import { spawnSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { pathToFileURL } from 'node:url';

const [bin, full, ...counts] = process.argv.slice(2);
if (!full) {
    console.error('looks_meshopt.mjs BIN_FOLDER FULL.ply [TRIANGLES...]');
    process.exit(2);
}
const library = process.env.MESHOPTIMIZER || 'node_modules/meshoptimizer';
const { MeshoptSimplifier } = await import(pathToFileURL(path.resolve(library, 'index.js')));
await MeshoptSimplifier.ready;

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'looks-'));
const cubewright = (...options) => {
    const run = spawnSync(path.join(bin, 'cubewright'), options, { maxBuffer: 1 << 26 });
    if (run.status > 1) throw Error(run.stderr.toString()); // 1: a mesh that is no manifold
    return run.stdout.toString();
};

// Reads positions, normals and triangles.
function readPly(file) {
    const bytes = fs.readFileSync(file), end = bytes.indexOf('end_header\n') + 11;
    const header = bytes.subarray(0, end).toString().split('\n'), properties = [];
    const vertices = +header.find(line => line.startsWith('element vertex')).split(' ')[2];
    const faces = +header.find(line => line.startsWith('element face')).split(' ')[2];
    let size = 0;
    for (const line of header.slice(0, header.findIndex(l => l.startsWith('element face')))) {
        const [word, kind, name] = line.split(' ');
        if (word !== 'property') continue;
        properties.push({ name, at: size, kind });
        size += kind === 'uchar' ? 1 : kind === 'double' ? 8 : 4;
    }
    const read = names => {
        const out = new Float32Array(3 * vertices), found = names.map(n => properties.find(p => p.name === n));
        if (found.some(p => !p)) throw Error(`${file}: no ${names[0]}: write it with normals, by extract`);
        for (let v = 0; v < vertices; v++)
            found.forEach((p, k) => { const at = end + v * size + p.at; out[3 * v + k] = p.kind === 'double' ? bytes.readDoubleLE(at) : bytes.readFloatLE(at); });
        return out;
    };
    const triangles = new Uint32Array(3 * faces);
    for (let t = 0; t < faces; t++)
        for (let k = 0; k < 3; k++) triangles[3 * t + k] = bytes.readUInt32LE(end + vertices * size + 13 * t + 1 + 4 * k);
    return { positions: read(['x', 'y', 'z']), normals: read(['nx', 'ny', 'nz']), triangles };
}

// Writes the vertices that triangles name.
function writePly(file, mesh, triangles) {
    const [remap, count] = MeshoptSimplifier.compactMesh(triangles), vertices = Buffer.alloc(24 * count);
    for (let v = 0; v < remap.length; v++)
        for (let k = 0; k < 3 && remap[v] !== 0xffffffff; k++) {
            vertices.writeFloatLE(mesh.positions[3 * v + k], 24 * remap[v] + 4 * k);
            vertices.writeFloatLE(mesh.normals[3 * v + k], 24 * remap[v] + 12 + 4 * k);
        }
    const faces = Buffer.alloc(13 * triangles.length / 3);
    for (let t = 0; t < triangles.length / 3; t++) {
        faces[13 * t] = 3;
        for (let k = 0; k < 3; k++) faces.writeUInt32LE(triangles[3 * t + k], 13 * t + 1 + 4 * k); // compacted in place
    }
    const header = ['ply', 'format binary_little_endian 1.0', `element vertex ${count}`, ...['x', 'y', 'z', 'nx', 'ny', 'nz'].map(p => `property float ${p}`),
        `element face ${triangles.length / 3}`, 'property list uchar int vertex_indices', 'end_header', ''].join('\n');
    fs.writeFileSync(file, Buffer.concat([Buffer.from(header), vertices, faces]));
}

const number = (x, digits) => x === null ? 'equal' : x.toFixed(digits);
function row(name, file, part = 'all') {
    const report = JSON.parse(cubewright('check', file, '--reference', full, '--looks', 'none', '--json', '-')), looks = report.looks[part] || report.looks.all;
    console.log(`| ${name} | ${report.mesh.triangles} | ${number(looks.psnr_db, 1)} | ${number(looks.ciede2000, 2)} | ${number(looks.psnr_inside_db, 1)} | ${number(looks.ciede2000_inside, 2)} |`);
}

console.log('| | triangles | PSNR | CIEDE2000 | inside: PSNR | CIEDE2000 |\n| --- | --- | --- | --- | --- | --- |');
try {
    const mesh = readPly(full), at = name => path.join(folder, name), none = 1e10;
    for (const count of counts.length ? counts.map(Number) : [10000, 12000, 100000]) {
        for (const [name, more] of [['ours', []], ['ours, by normals, too', ['--attributes', 'normal:0.1']]]) {
            cubewright('simplify', full, '--triangles', String(count), '--close-handles', 'auto', ...more, '-o', at('low.ply'));
            cubewright('uv', at('low.ply'), '--bake', full, '-o', at('low.glb'));
            row(`${name}, with a map`, at('low.glb'));
            row(`${name}, no map`, at('low.glb'), 'without_maps');
        }
        const plain = MeshoptSimplifier.simplify(mesh.triangles, mesh.positions, 3, 3 * count, none)[0].slice();
        writePly(at('plain.ply'), mesh, plain);
        row('meshoptimizer', at('plain.ply'));
        const by = MeshoptSimplifier.simplifyWithAttributes(mesh.triangles, mesh.positions, 3, mesh.normals, 3, [0.5, 0.5, 0.5], null, 3 * count, none)[0].slice();
        writePly(at('normals.ply'), mesh, by);
        row('meshoptimizer, by normals, too', at('normals.ply'));
        cubewright('uv', at('normals.ply'), '--bake', full, '-o', at('normals.glb'));
        row('the same, with a map of ours', at('normals.glb'));
    }
} finally {
    fs.rmSync(folder, { recursive: true, force: true });
}
