/* The view of three dimensions: the meshes of the page, drawn by WebGL. A mesh is a text of
   base64; packed_mesh.h says what its bytes are. Without WebGL the view stays hidden, and the
   pictures tell the same. */
(function () {
    'use strict';

    const STEPS = 65535;              // of positions along each side of the box
    const FIELD_OF_VIEW = Math.PI / 6;
    const TURN = 0.008;               // radians for each pixel of a drag
    const KEY_TURN = Math.PI / 24;
    const KEY_ZOOM = 1.15;
    const NEAREST = 0.15, FARTHEST = 6; // distances of the eye, relative to the first one

    const VERTEX_SHADER = `
        attribute vec3 place;
        attribute vec3 normal;
        attribute float level;
        uniform mat4 camera;
        uniform mat3 turn;
        varying vec3 direction;
        varying float at;
        void main() {
            direction = turn * normal;
            at = level;
            gl_Position = camera * vec4(place, 1.0);
        }`;

    /* Light from the eye, on both sides. The scale is a texture of one row. */
    const FRAGMENT_SHADER = `
        precision mediump float;
        uniform sampler2D scale;
        uniform float colored;
        varying vec3 direction;
        varying float at;
        void main() {
            vec3 n = normalize(direction);
            float facing = abs(n.z);
            vec3 plain = gl_FrontFacing ? vec3(0.88, 0.84, 0.75) : vec3(0.66, 0.38, 0.33);
            vec3 color = mix(plain, texture2D(scale, vec2(at, 0.5)).rgb, colored);
            gl_FragColor = vec4(color * (0.3 + 0.7 * facing) + 0.06 * pow(facing, 32.0), 1.0);
        }`;

    /* ---- the bytes of a mesh ---- */

    function decodeBase64(text) {
        const raw = atob(text.trim());
        const bytes = new Uint8Array(raw.length);
        for (let n = 0; n < raw.length; n++)
            bytes[n] = raw.charCodeAt(n);
        return bytes;
    }

    function unpackMesh(element) {
        const bytes = decodeBase64(element.textContent);
        const vertices = +element.dataset.vertices, triangles = +element.dataset.triangles;
        const box = element.dataset.box.split(' ').map(Number);
        const places = new Float32Array(3 * vertices), corners = new Uint32Array(3 * triangles);
        const before = [0, 0, 0];
        let at = 0;
        function readInteger() {
            let value = 0, shift = 0, byte;
            do {
                byte = bytes[at++];
                value |= (byte & 127) << shift;
                shift += 7;
            } while (byte > 127);
            return value >>> 0;
        }
        for (let n = 0; n < places.length; n++) {
            const code = readInteger(), axis = n % 3;
            before[axis] += code % 2 ? -(code + 1) / 2 : code / 2;
            places[n] = box[axis] + before[axis] / STEPS * (box[axis + 3] - box[axis]);
        }
        const hasLevels = element.dataset.levels === '1';
        const levels = hasLevels ? bytes.slice(at, at + vertices) : new Uint8Array(vertices);
        at += hasLevels ? vertices : 0;
        for (let n = 0, next = 0; n < corners.length; n++) {
            const below = readInteger();
            corners[n] = next - below;
            next += below === 0 ? 1 : 0;
        }
        if (at !== bytes.length)
            throw new Error('a mesh has ' + bytes.length + ' bytes, and ' + at + ' were read');
        return { places, corners, levels, hasLevels, box, normals: findNormals(places, corners) };
    }

    /* The mean of the triangles around each vertex, by area. */
    function findNormals(places, corners) {
        const normals = new Float32Array(places.length);
        for (let n = 0; n < corners.length; n += 3) {
            const a = 3 * corners[n], b = 3 * corners[n + 1], c = 3 * corners[n + 2];
            const ux = places[b] - places[a], uy = places[b + 1] - places[a + 1],
                uz = places[b + 2] - places[a + 2];
            const vx = places[c] - places[a], vy = places[c + 1] - places[a + 1],
                vz = places[c + 2] - places[a + 2];
            const x = uy * vz - uz * vy, y = uz * vx - ux * vz, z = ux * vy - uy * vx;
            for (const corner of [a, b, c]) {
                normals[corner] += x;
                normals[corner + 1] += y;
                normals[corner + 2] += z;
            }
        }
        for (let n = 0; n < normals.length; n += 3) {
            const length = Math.hypot(normals[n], normals[n + 1], normals[n + 2]) || 1;
            for (let axis = 0; axis < 3; axis++)
                normals[n + axis] /= length;
        }
        return normals;
    }

    /* ---- the camera: it stands on a sphere around the middle of the mesh ---- */

    function startCamera() { // in front of the patient: left is on the right, the head is up
        return { azimuth: 0, elevation: 0, distance: 0.8, across: 0, up: 0 };
    }

    /* Rows: to the right, up, and to the eye; in left, back, head. */
    function findAxes(camera) {
        const ca = Math.cos(camera.azimuth), sa = Math.sin(camera.azimuth);
        const ce = Math.cos(camera.elevation), se = Math.sin(camera.elevation);
        return [[ca, sa, 0], [-sa * se, ca * se, ce], [sa * ce, -ca * ce, se]];
    }

    function findMatrix(camera, axes, middle, radius, aspect) {
        const far = radius / Math.sin(FIELD_OF_VIEW / 2) * camera.distance;
        const near = Math.max(far - 1.02 * radius, 0.01 * radius), beyond = far + 1.02 * radius;
        const wide = 1 / Math.tan(FIELD_OF_VIEW / 2) * Math.min(1, aspect);
        const shift = [-camera.across * radius, -camera.up * radius, -far];
        const rows = axes.map((axis, n) => axis.concat(
            shift[n] - axis[0] * middle[0] - axis[1] * middle[1] - axis[2] * middle[2]));
        const depth = -(beyond + near) / (beyond - near), slope = -2 * beyond * near / (beyond - near);
        const matrix = new Float32Array(16); // by columns
        for (let column = 0; column < 4; column++) {
            matrix[4 * column] = rows[0][column] * wide / aspect;
            matrix[4 * column + 1] = rows[1][column] * wide;
            matrix[4 * column + 2] = rows[2][column] * depth + (column === 3 ? slope : 0);
            matrix[4 * column + 3] = -rows[2][column];
        }
        return matrix;
    }

    /* ---- WebGL ---- */

    function compileShader(gl, kind, text) {
        const shader = gl.createShader(kind);
        gl.shaderSource(shader, text);
        gl.compileShader(shader);
        if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS))
            throw new Error(gl.getShaderInfoLog(shader));
        return shader;
    }

    function makeProgram(gl) {
        const program = gl.createProgram();
        gl.attachShader(program, compileShader(gl, gl.VERTEX_SHADER, VERTEX_SHADER));
        gl.attachShader(program, compileShader(gl, gl.FRAGMENT_SHADER, FRAGMENT_SHADER));
        gl.linkProgram(program);
        if (!gl.getProgramParameter(program, gl.LINK_STATUS))
            throw new Error(gl.getProgramInfoLog(program));
        return program;
    }

    function makeScale(gl, colors) {
        const bytes = new Uint8Array(colors.flatMap((color) => color.concat(255)));
        gl.bindTexture(gl.TEXTURE_2D, gl.createTexture());
        gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1);
        gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA, colors.length, 1, 0, gl.RGBA, gl.UNSIGNED_BYTE,
            bytes);
        gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.NEAREST);
        gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.NEAREST);
        gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_S, gl.CLAMP_TO_EDGE);
        gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_T, gl.CLAMP_TO_EDGE);
    }

    /* WebGL 1 numbers vertices beyond 65535 only with an extension. */
    function openContext(canvas) {
        const wishes = { antialias: true, alpha: false, preserveDrawingBuffer: true };
        const gl = canvas.getContext('webgl2', wishes) || canvas.getContext('webgl', wishes);
        if (gl && gl instanceof WebGLRenderingContext && !gl.getExtension('OES_element_index_uint'))
            return null;
        return gl;
    }

    /* ---- a view of the page ---- */

    function startView(view) {
        const canvas = view.querySelector('canvas');
        const gl = openContext(canvas);
        if (!gl)
            return;
        const packed = Array.from(view.querySelectorAll('script[data-triangles]'));
        const choice = view.querySelector('select.mesh'), colored = view.querySelector('input');
        const words = view.querySelector('.words');
        const colors = view.dataset.colors.split(' ').map((c) => c.split(',').map(Number));
        const program = makeProgram(gl);
        const uniforms = {}, buffers = {};
        for (const name of ['camera', 'turn', 'scale', 'colored'])
            uniforms[name] = gl.getUniformLocation(program, name);
        for (const name of ['place', 'normal', 'level', 'corner'])
            buffers[name] = gl.createBuffer();
        const meshes = [];
        let shown = null, camera = startCamera(), waiting = false;

        function fill(name, values, size, type, normalized) {
            const at = gl.getAttribLocation(program, name);
            gl.bindBuffer(gl.ARRAY_BUFFER, buffers[name]);
            gl.bufferData(gl.ARRAY_BUFFER, values, gl.STATIC_DRAW);
            gl.enableVertexAttribArray(at);
            gl.vertexAttribPointer(at, size, type, normalized, 0, 0);
        }

        function chooseMesh(number) {
            meshes[number] = meshes[number] || unpackMesh(packed[number]);
            shown = meshes[number];
            fill('place', shown.places, 3, gl.FLOAT, false);
            fill('normal', shown.normals, 3, gl.FLOAT, false);
            fill('level', shown.levels, 1, gl.UNSIGNED_BYTE, true);
            gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, buffers.corner);
            gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, shown.corners, gl.STATIC_DRAW);
            words.textContent = packed[number].dataset.words;
            canvas.setAttribute('aria-label', packed[number].dataset.name +
                ', in three dimensions: arrow keys turn it, plus and minus zoom, 0 resets');
            draw();
        }

        function drawNow() {
            waiting = false;
            const ratio = Math.min(window.devicePixelRatio || 1, 2);
            canvas.width = Math.max(1, Math.round(canvas.clientWidth * ratio));
            canvas.height = Math.max(1, Math.round(canvas.clientHeight * ratio));
            gl.viewport(0, 0, canvas.width, canvas.height);
            const paper = getComputedStyle(canvas).backgroundColor.match(/[\d.]+/g).map(Number);
            gl.clearColor(paper[0] / 255, paper[1] / 255, paper[2] / 255, 1);
            gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
            gl.enable(gl.DEPTH_TEST);
            const box = shown.box, axes = findAxes(camera);
            const middle = [0, 1, 2].map((a) => (box[a] + box[a + 3]) / 2);
            const radius = Math.hypot(box[3] - box[0], box[4] - box[1], box[5] - box[2]) / 2 || 1;
            gl.useProgram(program);
            gl.uniformMatrix4fv(uniforms.camera, false,
                findMatrix(camera, axes, middle, radius, canvas.width / canvas.height));
            gl.uniformMatrix3fv(uniforms.turn, false, new Float32Array(
                [0, 1, 2].flatMap((column) => axes.map((axis) => axis[column]))));
            gl.uniform1i(uniforms.scale, 0);
            gl.uniform1f(uniforms.colored, colored.checked && shown.hasLevels ? 1 : 0);
            gl.drawElements(gl.TRIANGLES, shown.corners.length, gl.UNSIGNED_INT, 0);
            view.dataset.drawn = shown.corners.length / 3; // for tests, and the next line
            view.dataset.frames = (+view.dataset.frames || 0) + 1;
        }

        function draw() { // once for all events until the next frame
            if (!waiting)
                requestAnimationFrame(drawNow);
            waiting = true;
        }

        function turn(right, down) {
            camera.azimuth -= right;
            camera.elevation = Math.max(-Math.PI / 2, Math.min(Math.PI / 2, camera.elevation + down));
            draw();
        }

        function zoom(factor) {
            camera.distance = Math.max(NEAREST, Math.min(FARTHEST, camera.distance / factor));
            draw();
        }

        function move(right, down) {
            const reach = 2 * camera.distance / canvas.clientHeight;
            camera.across -= right * reach;
            camera.up += down * reach;
            draw();
        }

        function reset() {
            camera = startCamera();
            draw();
        }

        const keys = {
            ArrowLeft: () => turn(-KEY_TURN, 0), ArrowRight: () => turn(KEY_TURN, 0),
            ArrowUp: () => turn(0, -KEY_TURN), ArrowDown: () => turn(0, KEY_TURN),
            '+': () => zoom(KEY_ZOOM), '=': () => zoom(KEY_ZOOM), '-': () => zoom(1 / KEY_ZOOM),
            0: reset, Home: reset
        };
        canvas.addEventListener('keydown', function (event) {
            if (!keys[event.key] || event.ctrlKey || event.metaKey || event.altKey)
                return;
            keys[event.key]();
            event.preventDefault();
        });
        canvas.addEventListener('wheel', function (event) {
            event.preventDefault();
            zoom(Math.exp(-event.deltaY * (event.deltaMode === 1 ? 0.05 : 0.0015)));
        }, { passive: false });

        /* One finger or button turns, two fingers zoom and move, so does Shift or the right
           button. */
        const pointers = new Map();
        function spread() {
            const [a, b] = Array.from(pointers.values());
            return { width: Math.hypot(a.x - b.x, a.y - b.y), x: (a.x + b.x) / 2, y: (a.y + b.y) / 2 };
        }
        canvas.addEventListener('pointerdown', function (event) {
            canvas.focus({ preventScroll: true });
            canvas.setPointerCapture(event.pointerId);
            pointers.set(event.pointerId, { x: event.clientX, y: event.clientY });
        });
        canvas.addEventListener('pointermove', function (event) {
            const last = pointers.get(event.pointerId);
            if (!last)
                return;
            const before = pointers.size === 2 ? spread() : null;
            const here = { x: event.clientX, y: event.clientY };
            pointers.set(event.pointerId, here);
            if (before) {
                const after = spread();
                zoom(after.width / Math.max(before.width, 1));
                move(after.x - before.x, after.y - before.y);
            } else if (event.shiftKey || event.buttons === 2 || event.buttons === 4) {
                move(here.x - last.x, here.y - last.y);
            } else {
                turn(TURN * (here.x - last.x), TURN * (here.y - last.y));
            }
        });
        for (const end of ['pointerup', 'pointercancel'])
            canvas.addEventListener(end, (event) => pointers.delete(event.pointerId));
        canvas.addEventListener('contextmenu', (event) => event.preventDefault());

        view.querySelector('button').addEventListener('click', reset);
        choice.addEventListener('change', () => chooseMesh(choice.selectedIndex));
        colored.addEventListener('change', draw);
        window.addEventListener('resize', draw);
        matchMedia('(prefers-color-scheme: dark)').addEventListener('change', draw);
        choice.parentElement.hidden = packed.length === 1;
        makeScale(gl, colors);
        view.hidden = false;
        chooseMesh(0);
    }

    document.querySelectorAll('.view3d').forEach(function (view) {
        try {
            startView(view);
        } catch (error) {
            view.hidden = true;
            view.dataset.failed = error.message;
        }
        if (view.hidden)
            view.insertAdjacentHTML('afterend', '<p class="quiet">This browser cannot draw in three '
                + 'dimensions. The pictures below show the same.</p>');
    });
}());
