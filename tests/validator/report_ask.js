/* Asks the page of report what it does, as a reader would: buttons, sorting, a point and its row, the
   axis of a plot, the view of three dimensions, the contrast of texts. The answer is the title. */
/* Of a CSS colour, as WCAG 2 has it. */
function brightness(text) {
    const c = text.match(/[\d.]+/g).map(Number).map((v) => v / 255)
        .map((v) => v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4);
    return 0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2];
}
function paperOf(element) {
    for (let e = element; e; e = e.parentElement) {
        const color = getComputedStyle(e).backgroundColor;
        if (!/, 0\)$/.test(color))
            return color;
    }
    return 'rgb(255, 255, 255)';
}
function leastContrast() {
    let least = 21;
    for (const e of document.querySelectorAll('p, dt, dd, th, td, figcaption, strong, code, button, small, li, label, select, svg text')) {
        const style = getComputedStyle(e), color = e.closest('svg') ? style.fill : style.color;
        const [low, high] = [brightness(color), brightness(paperOf(e))].sort((a, b) => a - b);
        least = Math.min(least, (high + 0.05) / (low + 0.05));
    }
    return Math.floor(10 * least) / 10;
}
async function ask() {
    const said = [document.querySelectorAll('.copy').length,
        document.documentElement.scrollWidth - innerWidth,
        performance.getEntriesByType('resource').filter((e) => e.name.indexOf('data:') !== 0).length];
    const table = document.querySelector('table.sorts'), head = table.tHead.rows[0].cells[4];
    const order = () => Array.from(table.tBodies).map((body) => +body.rows[0].cells[4].dataset.v);
    head.querySelector('button').click();
    said.push(head.getAttribute('aria-sort') + order().every((v, n, all) => n === 0 || all[n - 1] <= v));
    head.querySelector('button').click();
    said.push(head.getAttribute('aria-sort') + order().every((v, n, all) => n === 0 || all[n - 1] >= v));
    const dot = document.querySelector('.dot'), row = document.querySelector('tbody[data-point="' + dot.dataset.point + '"]');
    dot.dispatchEvent(new FocusEvent('focusin'));
    said.push('row:' + row.classList.contains('lit'));
    dot.dispatchEvent(new FocusEvent('focusout'));
    row.dispatchEvent(new PointerEvent('pointerenter'));
    said.push('dot:' + dot.classList.contains('lit'));
    const plots = document.querySelector('.plots'), choice = plots.querySelector('select');
    choice.value = '1';
    choice.dispatchEvent(new Event('change'));
    said.push('axis:' + Array.from(plots.querySelectorAll('svg')).filter((e) => getComputedStyle(e).display !== 'none').map((e) => e.dataset.cost));
    const view = document.querySelector('.view3d'), canvas = view.querySelector('canvas');
    const picture = () => {
        const copy = document.createElement('canvas'), seen = new Set();
        copy.width = canvas.width;
        copy.height = canvas.height;
        copy.getContext('2d').drawImage(canvas, 0, 0);
        const data = copy.getContext('2d').getImageData(0, 0, copy.width, copy.height).data;
        let sum = 0;
        for (let n = 0; n < data.length; n += 4) {
            seen.add(data[n] << 16 | data[n + 1] << 8 | data[n + 2]);
            sum = (31 * sum + data[n] + 3 * data[n + 1] + 7 * data[n + 2]) % 1e9;
        }
        return { colors: seen.size, sum };
    };
    const wait = (ms) => new Promise((done) => setTimeout(done, ms));
    const frame = async (before) => { // until one was drawn, or for too long
        for (let n = 0; n < 60 && view.dataset.frames === before; n++)
            await wait(50);
    };
    const press = (key) => canvas.dispatchEvent(new KeyboardEvent('keydown', { key }));
    const drag = (x, y, event) => canvas.dispatchEvent(new PointerEvent(event,
        { pointerId: 1, clientX: x, clientY: y, buttons: 1 }));
    const first = picture(), works = [view.dataset.drawn === view.querySelector('script').dataset.triangles,
        first.colors > 100];
    const changes = async (act, expected) => {
        const before = picture().sum, frames = view.dataset.frames;
        act();
        await (expected ? frame(frames) : wait(300));
        works.push((picture().sum !== before) === expected);
    };
    await changes(() => press('ArrowLeft'), true);
    await changes(() => press('+'), true);
    await changes(() => press('x'), false);
    await changes(() => canvas.dispatchEvent(new WheelEvent('wheel', { deltaY: 300, cancelable: true })), true);
    canvas.setPointerCapture = () => {};
    await changes(() => { drag(100, 100, 'pointerdown'); drag(160, 120, 'pointermove'); }, true);
    drag(160, 120, 'pointerup');
    await changes(() => drag(200, 200, 'pointermove'), false);
    await changes(() => view.querySelector('.tools input').click(), true);
    const turned = view.dataset.frames;
    view.querySelector('.tools input').click();
    view.querySelector('.tools button').click();
    await frame(turned);
    works.push(picture().sum === first.sum);
    said.push('drawn:' + works.every((w) => w) + (works.every((w) => w) ? '' : works));
    const meshes = view.querySelector('select.mesh');
    const drawn = view.dataset.frames;
    meshes.selectedIndex = meshes.options.length - 1;
    meshes.dispatchEvent(new Event('change'));
    await frame(drawn);
    const last = Array.from(view.querySelectorAll('script')).pop();
    said.push('last:' + (view.dataset.drawn === last.dataset.triangles));
    document.title = 'asked ' + said.join(' ') + ' ' + leastContrast();
}
setTimeout(ask, 1000);
