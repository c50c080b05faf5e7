"""Plots the JSON lines of bench_splats as an SVG: error against processor time, a line for each
kernel, a point for each error of the octree.

python3 splats.py < splats.jsonl > splats.svg
"""
import json
import math
import sys

WIDTH, HEIGHT, LEFT, BELOW, ABOVE, RIGHT = 720, 400, 56, 48, 16, 150
COLORS = {"gaussian": "#1f6fb4", "polygon": "#b4531f", "tent": "#2b8a3e", "b-spline": "#7b3fa0"}


def place(value, low, high, start, end):
    """Maps a value to the picture on a logarithmic axis."""
    return start + (math.log(value) - math.log(low)) / (math.log(high) - math.log(low)) * (end - start)


def text(x, y, words, anchor="middle", color="#333"):
    return f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}" fill="{color}">{words}</text>'


def draw_axes(times, errors):
    """Draws grid lines and numbers: times at 1, 2 and 5 times powers of ten, errors at all digits."""
    out = []
    for power in range(-3, 4):
        for digit in range(1, 10):
            tick = digit * 10.0**power
            if digit in (1, 2, 5) and times[0] <= tick <= times[1]:
                x = place(tick, *times, LEFT, WIDTH - RIGHT)
                out.append(f'<path d="M{x:.1f} {ABOVE}V{HEIGHT - BELOW}" stroke="#ddd"/>')
                out.append(text(x, HEIGHT - BELOW + 18, f"{tick:g}"))
            if errors[0] <= tick <= errors[1]:
                y = place(tick, *errors, HEIGHT - BELOW, ABOVE)
                out.append(f'<path d="M{LEFT} {y:.1f}H{WIDTH - RIGHT}" stroke="#ddd"/>')
                out.append(text(LEFT - 8, y + 4, f"{tick:g}", "end"))
    out.append(text((LEFT + WIDTH - RIGHT) / 2, HEIGHT - 8, "processor time of a picture, s"))
    out.append(f'<g transform="rotate(-90 14 {HEIGHT / 2})">')
    out.append(text(14, HEIGHT / 2, "RMSE against the integral, 1/255") + "</g>")
    return out


def draw_kernel(name, rows, times, errors):
    """Draws a kernel's line; the open point is flat splatting."""
    color = COLORS[name]
    at = [(place(r["ms"] / 1000, *times, LEFT, WIDTH - RIGHT),
           place(r["rmse"], *errors, HEIGHT - BELOW, ABOVE)) for r in rows]
    line = " ".join(f"{x:.1f},{y:.1f}" for x, y in at[1:])
    out = [f'<polyline points="{line}" fill="none" stroke="{color}" stroke-width="1.5"/>']
    for row, (x, y) in zip(rows, at):
        fill = color if row["tree_error"] > 0 else "#fff"
        radius = 3.5 if row["tree_error"] > 0 else 5
        out.append(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{radius}" fill="{fill}" stroke="{color}">'
                   f'<title>{name}, tree error {row["tree_error"]:g}: {row["ms"]:.0f} ms, '
                   f'rmse {row["rmse"]:.2f}</title></circle>')
    return out


def main():
    rows = [json.loads(line) for line in sys.stdin if line.strip()]
    times = [0.9 * min(r["ms"] for r in rows) / 1000, 1.1 * max(r["ms"] for r in rows) / 1000]
    errors = [0.9 * min(r["rmse"] for r in rows), 1.1 * max(r["rmse"] for r in rows)]
    out = [f'<svg xmlns="http://www.w3.org/2000/svg" width="{WIDTH}" height="{HEIGHT}" '
           f'font-family="sans-serif" font-size="12"><rect width="100%" height="100%" fill="#fff"/>']
    out += draw_axes(times, errors)
    for n, name in enumerate(COLORS):
        chosen = [r for r in rows if r["kernel"] == name]
        if not chosen:
            continue
        out += draw_kernel(name, chosen, times, errors)
        y = ABOVE + 16 + 22 * n
        out.append(f'<circle cx="{WIDTH - RIGHT + 20}" cy="{y}" r="4" fill="{COLORS[name]}"/>')
        out.append(text(WIDTH - RIGHT + 32, y + 4, name, "start"))
    y = ABOVE + 16 + 22 * len(COLORS)
    out.append(f'<circle cx="{WIDTH - RIGHT + 20}" cy="{y}" r="5" fill="#fff" stroke="#333"/>')
    out.append(text(WIDTH - RIGHT + 32, y + 4, "flat, not a tree", "start"))
    print("\n".join(out) + "\n</svg>")


main()
