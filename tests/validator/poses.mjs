// Asks three.js for the boxes of posed glTF scenes, and compares those that cubewright reads:
// node poses.mjs FOLDER [GLTFPACK]. Writes the scenes into the folder: by three.js's exporter, by
// hand as other exporters write them, and by gltfpack, if its script is given. NODE_PATH names the
// place of three. Exit: 0 all boxes agree, 1 one does not, 77 no three.js.
import { execFileSync } from 'node:child_process';
import { readFileSync, writeFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { dirname, join } from 'node:path';

const [folder, gltfpack] = process.argv.slice(2);
let three;
try {
    three = dirname(dirname(createRequire(import.meta.url).resolve('three')));
} catch {
    console.error('skip: three.js is not installed');
    process.exit(77);
}
globalThis.self = globalThis;
globalThis.ProgressEvent = class {};
globalThis.FileReader = class {
    readAsArrayBuffer(blob) { blob.arrayBuffer().then(b => { this.result = b; this.onloadend(); }); }
    readAsDataURL(blob) {
        blob.arrayBuffer().then(b => {
            this.result = `data:application/octet-stream;base64,${Buffer.from(b).toString('base64')}`;
            this.onloadend();
        });
    }
};
const THREE = await import(join(three, 'build/three.module.js'));
const { GLTFLoader } = await import(join(three, 'examples/jsm/loaders/GLTFLoader.js'));
const { GLTFExporter } = await import(join(three, 'examples/jsm/exporters/GLTFExporter.js'));
const { MeshoptDecoder } = await import(join(three, 'examples/jsm/libs/meshopt_decoder.module.js'));

// --- scenes of three.js ---------------------------------------------------------------------

function morphed() {
    const geometry = new THREE.TorusGeometry(1, 0.3, 12, 24), position = geometry.attributes.position;
    const target = (fx, fy, fz) => {
        const array = new Float32Array(3 * position.count);
        for (let i = 0; i < position.count; i++)
            array.set([fx(position, i), fy(position, i), fz(position, i)], 3 * i);
        return new THREE.BufferAttribute(array, 3);
    };
    geometry.morphAttributes.position = [
        target((p, i) => p.getX(i), () => 0, () => 0), target(() => 0, (p, i) => p.getX(i) ** 2, () => 1)];
    geometry.morphTargetsRelative = true;
    const mesh = new THREE.Mesh(geometry, new THREE.MeshStandardMaterial());
    mesh.morphTargetInfluences = [0.75, -0.5];
    mesh.rotation.set(0.3, 0.5, 0.1);
    return mesh;
}

function skinned() {
    const geometry = new THREE.CylinderGeometry(0.4, 0.5, 4, 12, 16), position = geometry.attributes.position;
    const joints = [], weights = [];
    for (let i = 0; i < position.count; i++) {
        const at = (position.getY(i) + 2) / 2, joint = Math.min(Math.floor(at), 1);
        joints.push(joint, joint + 1, 0, 0);
        weights.push(1 - (at - joint), at - joint, 0, 0);
    }
    geometry.setAttribute('skinIndex', new THREE.Uint16BufferAttribute(joints, 4));
    geometry.setAttribute('skinWeight', new THREE.Float32BufferAttribute(weights, 4));
    const bones = [0, 1, 2].map(() => new THREE.Bone());
    bones.forEach((bone, n) => { bone.position.y = n ? 2 : -2; bones[n - 1]?.add(bone); });
    const mesh = new THREE.SkinnedMesh(geometry, new THREE.MeshStandardMaterial());
    mesh.add(bones[0]);
    mesh.updateMatrixWorld(true);
    mesh.bind(new THREE.Skeleton(bones));
    bones[1].rotation.set(0.7, 0.2, 0.4);
    bones[2].scale.set(1.5, 1, 2);
    const group = new THREE.Group();
    group.position.set(3, 4, 5);
    group.add(mesh);
    return group;
}

function instanced() {
    const mesh = new THREE.InstancedMesh(new THREE.ConeGeometry(0.5, 2, 8), new THREE.MeshStandardMaterial(), 9);
    for (let n = 0; n < 9; n++)
        mesh.setMatrixAt(n, new THREE.Matrix4().compose(
            new THREE.Vector3(3 * n, n % 2, -n * n / 4), new THREE.Quaternion().setFromEuler(new THREE.Euler(n, n / 2, 0)),
            new THREE.Vector3(1, 1 + n / 5, n === 4 ? -1 : 1)));
    mesh.position.set(0, 7, 0);
    mesh.scale.setScalar(0.5);
    return mesh;
}

function exported(scene) {
    return new GLTFExporter().parseAsync(scene, { binary: true, onlyVisible: false }).then(Buffer.from);
}

// --- scenes by hand, as other exporters write them -------------------------------------------

class Arrays {
    bytes = []; views = []; accessors = [];
    add(array, componentType, type, more = {}) {
        const numbers = { SCALAR: 1, VEC3: 3, VEC4: 4, MAT4: 16 }[type];
        while (this.bytes.length % 4)
            this.bytes.push(0);
        this.views.push({ buffer: 0, byteOffset: this.bytes.length, byteLength: array.byteLength });
        this.bytes.push(...new Uint8Array(array.buffer));
        const lists = [...Array(numbers).keys()].map(c => array.filter((_, i) => i % numbers === c));
        const bounds = type === 'VEC3' ? { min: lists.map(l => Math.min(...l)), max: lists.map(l => Math.max(...l)) } : {};
        this.accessors.push({ bufferView: this.views.length - 1, componentType, type, count: array.length / numbers,
                              ...bounds, ...more });
        return this.accessors.length - 1;
    }
    text(rest) {
        const uri = `data:application/octet-stream;base64,${Buffer.from(this.bytes).toString('base64')}`;
        return JSON.stringify({ asset: { version: '2.0' }, scene: 0, scenes: [{ nodes: [0] }],
                                buffers: [{ byteLength: this.bytes.length, uri }], bufferViews: this.views,
                                accessors: this.accessors, ...rest });
    }
}

const corners = new Float32Array([0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0, 3]), faces = new Uint16Array([0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3]);

// As Blender: sparse targets, floats; weights of the mesh.
function blenderMorph() {
    const a = new Arrays(), position = a.add(corners, 5126, 'VEC3'), indices = a.add(faces, 5123, 'SCALAR');
    const at = a.add(new Uint16Array([1, 3]), 5123, 'SCALAR'), by = a.add(new Float32Array([2, 1, 0, 0, 0, -9]), 5126, 'VEC3');
    a.accessors.push({ componentType: 5126, type: 'VEC3', count: 4, min: [0, 0, -9], max: [2, 1, 0],
                       sparse: { count: 2, indices: { bufferView: at, componentType: 5123 }, values: { bufferView: by } } });
    return a.text({ nodes: [{ mesh: 0, scale: [2, 1, 1] }], meshes: [{ weights: [0.5], primitives: [
        { attributes: { POSITION: position }, indices, targets: [{ POSITION: a.accessors.length - 1 }] }] }] });
}

// As gltfpack: positions and displacements in 16 bits, weights of the node.
function packedMorph() {
    const a = new Arrays(), indices = a.add(faces, 5123, 'SCALAR'), more = { normalized: true };
    const position = a.add(new Int16Array([0, 0, 0, 0, 32767, 0, 0, 0, 0, 16000, 0, 0, 0, 0, 30000, 0]), 5122, 'VEC4', more);
    a.views[position].byteStride = 8;
    Object.assign(a.accessors[position], { type: 'VEC3', min: [0, 0, 0], max: [32767, 16000, 30000] });
    const target = a.add(new Int16Array([0, 0, 0, 0, 0, 9000, 0, 0, -32767, 0, 0, 0, 0, 0, 0, 0]), 5122, 'VEC4', more);
    a.views[target].byteStride = 8;
    Object.assign(a.accessors[target], { type: 'VEC3', min: [-32767, 0, 0], max: [0, 9000, 0] });
    return a.text({ extensionsUsed: ['KHR_mesh_quantization'], extensionsRequired: ['KHR_mesh_quantization'],
        nodes: [{ mesh: 0, weights: [0.8], scale: [3, 3, 3] }],
        meshes: [{ weights: [0], primitives: [{ attributes: { POSITION: position }, indices, targets: [{ POSITION: target }] }] }] });
}

// A skin in bytes whose mesh is a child of a joint; with or without inverseBindMatrices.
function handSkin(bound) {
    const a = new Arrays(), position = a.add(corners, 5126, 'VEC3'), indices = a.add(faces, 5123, 'SCALAR');
    const joints = a.add(new Uint8Array([0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 1, 0, 0, 0]), 5121, 'VEC4');
    const weights = bound ? a.add(new Uint8Array([255, 0, 0, 0, 255, 0, 0, 0, 55, 200, 0, 0, 255, 0, 0, 0]), 5121, 'VEC4', { normalized: true })
                          : a.add(new Float32Array([1, 0, 0, 0, 2, 0, 0, 0, 0.5, 1.5, 0, 0, 1, 0, 0, 0]), 5126, 'VEC4');
    const skin = { joints: [1, 2] };
    if (bound)
        skin.inverseBindMatrices = a.add(new Float32Array([1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1,
                                                           0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1, 0, -2, 1, 0, 1]), 5126, 'MAT4');
    return a.text({ nodes: [{ children: [1, 3], rotation: [0, 0.6, 0, 0.8] }, { children: [2], translation: [0, 5, 1] },
                            { scale: [1, 2, 3], translation: [1, 1, 1] }, { mesh: 0, skin: 0, translation: [9, 9, 9] }],
                    skins: [skin], meshes: [{ primitives: [{ attributes: { POSITION: position, JOINTS_0: joints, WEIGHTS_0: weights }, indices }] }] });
}

// Instances with rotations in 8 or 16 bits, of unit length to the bit, or with scales alone.
function handInstances(kind) {
    const a = new Arrays(), position = a.add(corners, 5126, 'VEC3'), indices = a.add(faces, 5123, 'SCALAR'), attributes = {};
    if (kind)
        attributes.TRANSLATION = a.add(new Float32Array([0, 0, 0, 10, 5, 0, -4, 0, 20]), 5126, 'VEC3');
    if (kind === 1)
        attributes.ROTATION = a.add(new Int8Array([0, 0, 0, 127, 63, 72, 80, 24, 127, 0, 0, 0]), 5120, 'VEC4', { normalized: true });
    if (kind === 2)
        attributes.ROTATION = a.add(new Int16Array([0, 0, 0, 32767, 16383, 11392, 25344, 5760, 0, 32767, 0, 0]), 5122, 'VEC4', { normalized: true });
    attributes.SCALE = a.add(new Float32Array([1, 1, 1, 2, 1, 1, 1, 3, -1]), 5126, 'VEC3');
    return a.text({ extensionsUsed: ['EXT_mesh_gpu_instancing'], nodes: [{ mesh: 0, rotation: [0, 0.6, 0, 0.8],
        extensions: { EXT_mesh_gpu_instancing: { attributes } } }], meshes: [{ primitives: [{ attributes: { POSITION: position }, indices }] }] });
}

// --- boxes --------------------------------------------------------------------------------------

function boxOf(scene) {
    const box = new THREE.Box3(), p = new THREE.Vector3(), m = new THREE.Matrix4();
    scene.updateMatrixWorld(true);
    scene.traverse(o => {
        for (let i = 0; o.isMesh && i < o.geometry.attributes.position.count; i++) {
            o.getVertexPosition(i, p);
            for (let n = 0; n < (o.isInstancedMesh ? o.count : 1); n++) {
                const at = p.clone();
                if (o.isInstancedMesh)
                    at.applyMatrix4((o.getMatrixAt(n, m), m));
                box.expandByPoint(at.applyMatrix4(o.matrixWorld));
            }
        }
    });
    return box;
}

async function compare(name, bytes) {
    const file = join(folder, name);
    writeFileSync(file, bytes);
    const loader = new GLTFLoader().setMeshoptDecoder(MeshoptDecoder), data = readFileSync(file);
    const { scene } = await loader.parseAsync(name.endsWith('.glb') ? data.buffer.slice(data.byteOffset, data.byteOffset + data.length)
                                                                    : data.toString(), '');
    const { min, max } = boxOf(scene); // in metres, +Y up
    const theirs = [[min.x, -max.z, min.y], [max.x, -min.z, max.y]].map(p => p.map(x => 1000 * x));
    execFileSync('cubewright', ['convert', file, '-o', join(folder, 'x.stl'), '--json', join(folder, 'x.json'), '-q']);
    const { box } = JSON.parse(readFileSync(join(folder, 'x.json'))).mesh;
    const ours = [box.slice(0, 3), box.slice(3)], size = Math.hypot(...[0, 1, 2].map(a => theirs[1][a] - theirs[0][a]));
    const far = Math.max(...[0, 1].map(e => Math.max(...[0, 1, 2].map(a => Math.abs(theirs[e][a] - ours[e][a])))));
    console.log(`${name}: ${far < 2e-6 * size ? 'the same box' : `not the same: ${theirs} and ${ours}`}`);
    return far < 2e-6 * size;
}

const scenes = {
    'three-morph.glb': await exported(morphed()), 'three-skin.glb': await exported(skinned()),
    'three-instances.glb': await exported(instanced()),
    'blender-morph.gltf': blenderMorph(), 'packed-morph.gltf': packedMorph(),
    'bound-skin.gltf': handSkin(true), 'plain-skin.gltf': handSkin(false),
    'scales.gltf': handInstances(0), 'bytes.gltf': handInstances(1), 'shorts.gltf': handInstances(2)
};
let good = true;
for (const [name, bytes] of Object.entries(scenes))
    good = await compare(name, bytes) && good;
for (const [name, options] of gltfpack ? [['three-morph.glb', []], ['three-skin.glb', []], ['three-instances.glb', ['-mi']], ['three-instances.glb', ['-mi', '-cc']],
                                          ['three-morph.glb', ['-cc']], ['three-skin.glb', ['-cc']]] : []) {
    const packed = join(folder, 'packed.glb');
    execFileSync(process.execPath, [gltfpack, '-i', join(folder, name), '-o', packed, '-noq', ...options].filter(o => o !== '-noq' || !options.includes('-cc')));
    good = await compare(`gltfpack-${options.join('')}-${name}`, readFileSync(packed)) && good;
}
process.exitCode = good ? 0 : 1;
