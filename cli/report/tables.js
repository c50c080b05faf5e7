/* What plots and tables do: rows are sorted by any column, a point and its row show each other,
   the axis of a plot is chosen, and commands are copied. Without it all is there to be read. */
(function () {
    'use strict';

    /* ---- commands ---- */

    function selectText(element) {
        const range = document.createRange();
        range.selectNodeContents(element);
        getSelection().removeAllRanges();
        getSelection().addRange(range);
    }

    document.querySelectorAll('code[data-copy]').forEach(function (code) {
        const button = document.createElement('button');
        button.type = 'button';
        button.className = 'copy';
        button.textContent = 'copy';
        button.addEventListener('click', function () {
            function select() {
                selectText(code);
                button.textContent = 'selected';
            }
            if (navigator.clipboard)
                navigator.clipboard.writeText(code.textContent).then(
                    () => { button.textContent = 'copied'; }, select);
            else
                select();
        });
        code.after(button);
    });

    /* ---- tables: each point is a <tbody> of a row of numbers and a row with its command ---- */

    function valueOf(body, column) {
        const cell = body.rows[0].cells[column];
        return cell.dataset.v !== undefined ? Number(cell.dataset.v) : cell.textContent;
    }

    /* Numbers by size, unknown ones last in either direction, texts by the alphabet. */
    function compareValues(a, b, sign) {
        const unknown = (x) => typeof x === 'number' && isNaN(x) ? 1 : 0;
        if (unknown(a) || unknown(b))
            return unknown(a) - unknown(b);
        return sign * (typeof a === 'number' ? a - b : a.localeCompare(b));
    }

    function sortTable(table, head) {
        const falls = head.getAttribute('aria-sort') === 'ascending';
        for (const other of table.tHead.rows[0].cells)
            other.removeAttribute('aria-sort');
        head.setAttribute('aria-sort', falls ? 'descending' : 'ascending');
        Array.from(table.tBodies)
            .sort((a, b) => compareValues(valueOf(a, head.cellIndex), valueOf(b, head.cellIndex),
                falls ? -1 : 1))
            .forEach((body) => table.append(body));
    }

    document.querySelectorAll('table.sorts').forEach(function (table) {
        for (const head of table.tHead.rows[0].cells) {
            const button = document.createElement('button');
            button.type = 'button';
            button.className = 'sort';
            button.append(...head.childNodes);
            head.append(button);
            button.addEventListener('click', () => sortTable(table, head));
        }
    });

    /* ---- a point and its row ---- */

    function markPoint(name, on) {
        document.querySelectorAll('[data-point="' + name + '"]').forEach(
            (element) => element.classList.toggle('lit', on));
    }

    document.querySelectorAll('[data-point]').forEach(function (element) {
        const name = element.dataset.point;
        for (const [event, on] of [['pointerenter', true], ['pointerleave', false],
            ['focusin', true], ['focusout', false]])
            element.addEventListener(event, () => markPoint(name, on));
        if (element.classList.contains('dot')) {
            const show = () => document.querySelector('tbody[data-point="' + name + '"]')
                .scrollIntoView({ block: 'nearest' });
            element.addEventListener('click', show);
            element.addEventListener('keydown', (event) => event.key === 'Enter' ? show() : null);
        }
    });

    /* ---- the axis of a plot ---- */

    document.querySelectorAll('.plots').forEach(function (plots) {
        const choice = plots.querySelector('select');
        if (!choice)
            return;
        choice.parentElement.hidden = false;
        choice.addEventListener('change', function () {
            plots.querySelectorAll('svg').forEach(function (plot) {
                plot.toggleAttribute('hidden', plot.dataset.cost !== choice.value);
            });
        });
    });
}());
