// Loads GLB files with three.js in headless Chromium, Draco's and meshopt's decoders included:
// node three.mjs [--names] [--picture OUT.png] FILE...
// node three.mjs --steps TIME=FILE[,TIME=FILE...] ANIMATED
// Prints for each file: its triangles, and its box in metres. With --names, also the name, colour and
// label of each mesh. With --steps, plays the animation of a
// file: at each time, on the way there and back, the picture must be that of the other file, seen
// from the same place, or without a name that of nothing; and pictures of different files must
// differ. Exit: 0 all loaded and alike, 1 one did not, 2 usage, 77 no Chromium, three.js or
// puppeteer. NODE_PATH names where the latter two are.
import { createReadStream, existsSync } from 'node:fs';
import { createServer } from 'node:http';
import { createRequire } from 'node:module';
import { basename, dirname, extname, join } from 'node:path';

const CHROMIUM = ['/usr/bin/chromium', '/usr/bin/chromium-browser', '/usr/bin/google-chrome'];
const ROUNDED_PIXELS = 200; // that compression may change, of 409,600
const TYPES = { '.html': 'text/html', '.js': 'text/javascript', '.wasm': 'application/wasm' };

function skip(what) {
    console.error(`skip: ${what} is not installed`);
    process.exit(77);
}

function find(name) {
    try {
        return createRequire(import.meta.url).resolve(name);
    } catch {
        return skip(name);
    }
}

// The page and what it imports, from one server: modules and workers need an origin.
const PAGE = `<!doctype html><body style="margin:0"><script type="importmap">
{"imports": {"three": "/three/build/three.module.js", "three/addons/": "/three/examples/jsm/"}}
</script><script type="module">
import * as THREE from 'three';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';
import { DRACOLoader } from 'three/addons/loaders/DRACOLoader.js';
import { MeshoptDecoder } from 'three/addons/libs/meshopt_decoder.module.js';
const draco = new DRACOLoader().setDecoderPath('/three/examples/jsm/libs/draco/gltf/');
const loader = new GLTFLoader().setDRACOLoader(draco).setMeshoptDecoder(MeshoptDecoder);
const renderer = new THREE.WebGLRenderer({ antialias: true, preserveDrawingBuffer: true });
renderer.setSize(innerWidth, innerHeight);
document.body.appendChild(renderer.domElement);
function look(box) {
    const size = box.getSize(new THREE.Vector3()).length(), middle = box.getCenter(new THREE.Vector3());
    const camera = new THREE.PerspectiveCamera(35, innerWidth / innerHeight, size / 100, size * 10);
    camera.position.set(middle.x + 0.2 * size, middle.y, middle.z + 1.6 * size);
    camera.lookAt(middle);
    return camera;
}
function light(scene) {
    scene.background = new THREE.Color(0xdddddd);
    const light = new THREE.DirectionalLight(0xffffff, 2.5);
    light.position.set(1, 1, 2);
    scene.add(light, new THREE.AmbientLight(0xffffff, 0.6));
}
function draw(scene, camera) {
    light(scene);
    renderer.render(scene, camera);
}
function pixels() {
    const gl = renderer.getContext(), bytes = new Uint8Array(4 * gl.drawingBufferWidth * gl.drawingBufferHeight);
    gl.readPixels(0, 0, gl.drawingBufferWidth, gl.drawingBufferHeight, gl.RGBA, gl.UNSIGNED_BYTE, bytes);
    return bytes;
}
// How many pixels differ visibly.
function differing(a, b) {
    let count = 0;
    for (let i = 0; i < a.length; i += 4)
        count += Math.max(...[0, 1, 2].map(c => Math.abs(a[i + c] - b[i + c]))) > 8 ? 1 : 0;
    return count;
}
async function picture(url, camera) {
    const scene = url ? (await loader.loadAsync(url)).scene : new THREE.Group();
    draw(scene, camera);
    return pixels();
}
window.play = async (url, steps) => {
    const { scene, animations } = await loader.loadAsync(url);
    const box = new THREE.Box3();
    for (const s of steps.filter(s => s.url))
        box.union(new THREE.Box3().setFromObject((await loader.loadAsync(s.url)).scene, true));
    const camera = look(box), truth = [], found = [];
    for (const s of steps)
        truth.push(await picture(s.url, camera));
    for (let i = 1; i < truth.length; i++)
        if (steps[i].url !== steps[i - 1].url && differing(truth[i - 1], truth[i]) < 1000)
            throw new Error('steps ' + (i - 1) + ' and ' + i + ' look alike: they prove nothing');
    const mixer = new THREE.AnimationMixer(scene);
    for (const clip of animations)
        mixer.clipAction(clip).play();
    light(scene);
    for (const i of [...steps.keys(), ...[...steps.keys()].reverse()]) {
        mixer.setTime(steps[i].time);
        renderer.render(scene, camera);
        found.push([i, steps[i].time, differing(pixels(), truth[i])]);
    }
    return { duration: animations[0].duration, found };
};
window.load = async url => {
    const { scene } = await loader.loadAsync(url);
    let triangles = 0, nodes = 0;
    const names = [];
    scene.updateMatrixWorld(true);
    scene.traverse(o => {
        nodes += o.isMesh ? 1 : 0;
        if (o.isMesh)
            names.push(o.name + ' #' + o.material.color.getHexString() + ' ' + o.material.opacity.toFixed(3) +
                       ' ' + o.userData.label);
        triangles += o.isMesh ? o.geometry.index.count / 3 : 0;
    });
    const box = new THREE.Box3().setFromObject(scene, true), stated = new THREE.Box3().setFromObject(scene);
    if (box.min.distanceTo(stated.min) > 1e-6 || box.max.distanceTo(stated.max) > 1e-6)
        throw new Error('the box that the accessors state is not that of their positions');
    draw(scene, look(box));
    return { triangles, nodes, names, low: box.min.toArray(), high: box.max.toArray() };
};
window.ready = true;
</script>`;

function serve(three, files) {
    const server = createServer((request, response) => {
        const name = decodeURIComponent(request.url);
        const path = name.startsWith('/three/') ? join(three, name.slice(7)) : files[name.slice(6)];
        response.setHeader('Content-Type', TYPES[extname(name)] ?? 'application/octet-stream');
        if (name === '/page.html')
            response.end(PAGE);
        else if (path && existsSync(path))
            createReadStream(path).pipe(response);
        else
            response.writeHead(404).end();
    });
    return new Promise(done => server.listen(0, '127.0.0.1', () => done(server)));
}

const words = process.argv.slice(2);
const tells = words[0] === '--names' && words.splice(0, 1);
const picture = words[0] === '--picture' ? words.splice(0, 2)[1] : null;
const steps = words[0] === '--steps' ? words.splice(0, 2)[1].split(',').map(s => s.split('=')) : null;
if (words.length === 0 || (steps && words.length > 1)) {
    console.error('usage: three.mjs [--picture OUT.png] FILE... or --steps TIME=FILE,... FILE');
    process.exit(2);
}
const chromium = CHROMIUM.find(existsSync) ?? skip('chromium');
const three = dirname(dirname(find('three')));
const puppeteer = createRequire(import.meta.url)(find('puppeteer-core'));
const files = steps ? [...words, ...steps.map(([, file]) => file)] : words;
const server = await serve(three, Object.fromEntries(files.map((f, i) => [String(i), f])));
const browser = await (puppeteer.default ?? puppeteer).launch({
    executablePath: chromium,
    args: ['--no-sandbox', '--use-angle=swiftshader', '--enable-unsafe-swiftshader'],
});
let failed = false;
try {
    const page = await browser.newPage();
    await page.setViewport({ width: 640, height: 640 });
    page.on('pageerror', e => console.error(`page: ${e.message}`));
    await page.goto(`http://127.0.0.1:${server.address().port}/page.html`);
    await page.waitForFunction('window.ready');
    if (steps) {
        const list = steps.map(([time, file]) =>
            ({ time: Number(time), url: file ? `/file/${files.indexOf(file)}` : '' }));
        const r = await page.evaluate((u, l) => window.play(u, l).catch(e => ({ error: String(e) })),
                                      '/file/0', list);
        console.log(r.error ?? `${basename(words[0])} ${r.duration.toFixed(3)} s`);
        for (const [i, time, count] of r.found ?? [])
            console.log(`  at ${time} s: ${count} pixels are not those of ${steps[i][1] || 'nothing'}`);
        failed = Boolean(r.error) || r.found.some(([, , count]) => count > ROUNDED_PIXELS);
    }
    for (const [i, file] of steps ? [] : words.entries()) {
        const r = await page.evaluate(u => window.load(u).catch(e => ({ error: String(e) })), `/file/${i}`);
        failed ||= Boolean(r.error);
        console.log(r.error ? `${basename(file)}: ${r.error}`
                            : `${basename(file)} ${r.nodes} ${r.triangles} ` +
                              [...r.low, ...r.high].map(x => x.toFixed(6)).join(' '));
        for (const name of (tells && r.names) || [])
            console.log(`  ${name}`);
        if (picture)
            await page.screenshot({ path: picture.replace('{stem}', basename(file, '.glb')) });
    }
} finally {
    await browser.close();
    server.close();
}
process.exitCode = failed ? 1 : 0;
