// Projects values along rays: the highest (MIP), the lowest, the mean, and the first maximum
// above a threshold (LOCAL). INSIDE: the lowest between the first and the last value that reaches
// the threshold. A volume in bricks is traversed front to back; each pass reads the
// result of the one before.
uniform sampler3D ranges; // of texels in each block
uniform vec3 last_block;  // of these
uniform sampler2D
    before; // value; length so far, or INSIDE: the lowest value since the ray last
            // reached the threshold; 1: LOCAL is done; the last value
uniform float step_length, threshold;
uniform float rise; // 1, or -1 where values rise as texels fall
out vec4 result;

const float none = 3e38;

// Returns a value of the field as texels have it, but that it rises where values rise.
float value_on(ray r, float t)
{
    return rise * texel_on(r, t);
}

vec2 range_of(vec3 at)
{
    return texelFetch(ranges, ivec3(min(at * 0.125, last_block)), 0).rg;
}

float block_exit(ray r, vec3 at)
{
    vec3 low = floor(at * 0.125) * 8.0;
    return box_exit(r, at, low, low + 8.0);
}

// Returns true if nothing in a range changes what was found.
bool is_useless(vec2 range, vec4 found)
{
#if defined(INSIDE)
    bool is_below = range.y < threshold;
    return found.x < none ? range.x >= found.x && (is_below || found.y >= found.x) : is_below;
#elif defined(MIP)
    return range.y <= found.x;
#else
    return range.x >= found.x;
#endif
}

// Returns how far a ray goes without a change of the value found.
float useless_length(ray r, vec3 at, vec4 found)
{
#if defined(MIP) || defined(MINIP)
    if (is_useless(range_of(at), found))
        return block_exit(r, at);
#endif
    return 0.0;
}

#ifdef INSIDE
vec4 take_inside(vec4 found, float value)
{
    if (value >= threshold) {
        found.x = min(found.x, min(found.x < none ? found.y : none, value));
        found.y = none;
    } else if (value < found.y && found.x < none) {
        found.y = value;
    }
    return found;
}
#endif

vec4 take(vec4 found, float value)
{
#ifdef MIP
    found.x = value > found.x ? value : found.x;
#endif
#if defined(INSIDE)
    if (isnan(value)) {
        found.w = none; // the next value follows on nothing
    } else {
        if (found.w < none && (found.w < threshold) != (value < threshold))
            found = take_inside(found, threshold); // where they cross it
        found = take_inside(found, value);
        found.w = value;
    }
#elif defined(MINIP)
    found.x = value < found.x ? value : found.x;
#endif
#ifdef LOCAL
    if (found.z < 0.5) {
        if (found.x >= threshold && value < found.w)
            found.z = 1.0; // it falls: the last one was a maximum
        else
            found.x = value > found.x ? value : found.x;
        found.w = value;
    }
#endif
    return found;
}

// Takes the extrema of the cubic through values at 0, 1/3, 2/3 and 1 of a cell; a trilinear
// field is a cubic along a ray.
vec4 take_cell(vec4 found, vec4 v)
{
    float b = -5.5 * v.x + 9.0 * v.y - 4.5 * v.z + v.w;
    float c = 9.0 * v.x - 22.5 * v.y + 18.0 * v.z - 4.5 * v.w;
    float d = -4.5 * v.x + 13.5 * v.y - 13.5 * v.z + 4.5 * v.w;
    float inner = c * c - 3.0 * b * d;
    if (inner >= 0.0) {
        float q = -(c + (c < 0.0 ? -1.0 : 1.0) * sqrt(inner));
        vec2 roots = vec2(q / (3.0 * d), b / q); // may be infinite: not inside
        roots = vec2(min(roots.x, roots.y), max(roots.x, roots.y));
        for (int n = 0; n < 2; n++)
            if (roots[n] > 0.0 && roots[n] < 1.0)
                found = take(found, ((d * roots[n] + c) * roots[n] + b) * roots[n] + v.x);
    }
    return take(found, v.w);
}

// Finds a value that the ray reaches for certain, from the ranges of the blocks it passes and
// from samples of the most promising block. Shortens the part of the ray, by whole steps, to
// where a better value may be.
vec4 foresee(ray r, inout vec2 part, vec4 found)
{
#ifdef FORESEE
    float best = -none, best_from = part.x;
    vec2 useful = part.xx;
    for (float t = part.x; t < part.y;) {
        vec3 at = r.index + t * r.slope;
        vec2 range = range_of(at);
#ifdef MIP
        found.x = max(found.x, range.x);
        float promise = range.y, bound = found.x;
#else
        found.x = min(found.x, range.y);
        float promise = -range.x, bound = -found.x;
#endif
        useful.x = bound >= best ? t - 0.01 : useful.x;
        best_from = promise > best ? t : best_from;
        best = max(best, promise);
        t += block_exit(r, at) + 0.01;
        useful.y = promise > bound ? t : useful.y;
    }
    float until = min(part.y, best_from + block_exit(r, r.index + best_from * r.slope));
    found = take(found, value_on(r, mix(best_from, until, 0.5)));
    found = take(found, value_on(r, until));
    part = vec2(part.x + max(floor((useful.x - part.x) / step_length), 0.0) * step_length,
                min(part.y, useful.y));
#endif
    return found;
}

#ifdef CELLS
// Goes cell by cell; values at a cell's ends are shared.
vec4 along(ray r, float from, float to, vec4 found)
{
    float value = value_on(r, from);
    for (float t = from; t < to && found.z < 0.5;) {
        vec3 at = r.index + t * r.slope;
        float useless = useless_length(r, at, found);
        if (useless > 0.01) {
            t += useless;
            value = value_on(r, t);
#ifdef INSIDE
            found.w = none;
#endif
            continue;
        }
        float extent = min(cell_exit(r, at), to - t);
        vec4 v = vec4(value, value_on(r, t + extent / 3.0),
                      value_on(r, t + extent * (2.0 / 3.0)), value_on(r, t + extent));
        value = v.w;
#ifdef AVERAGE
        float mean = (v.x + v.w) / 8.0 + (v.y + v.z) * 0.375;
        found.xy += isnan(mean) ? vec2(0.0) : extent * vec2(mean, 1.0);
#else
        found = take_cell(take(found, v.x), v);
#endif
        t += extent;
    }
    return found;
}
#else
#ifdef AVERAGE
// Takes the middles of steps.
vec4 along(ray r, float from, float to, vec4 found)
{
    for (float t = from; t < to; t += step_length) {
        float extent = min(step_length, to - t);
        float mean = value_on(r, t + 0.5 * extent);
        found.xy += isnan(mean) ? vec2(0.0) : extent * vec2(mean, 1.0);
    }
    return found;
}
#else
// Takes samples a step apart, and the last at the end: skips useless parts, then goes through a
// block.
vec4 along(ray r, float from, float to, vec4 found)
{
    float t = from;
    while (t < to && found.z < 0.5) {
        float until = to;
#if defined(MIP) || defined(MINIP)
        float useless = useless_length(r, r.index + t * r.slope, found);
#ifdef INSIDE
        bool is_skipping = useless > 0.0;
#endif
        while (useless > 0.0 && t < to) {
            t += max(ceil(useless / step_length), 1.0) * step_length;
            useless = useless_length(r, r.index + t * r.slope, found);
        }
#ifdef INSIDE
        float last = value_on(r, min(t - step_length, to)); // that was skipped
        if (is_skipping)
            found.w = isnan(last) ? none : last;
#endif
        until = min(to, t + block_exit(r, r.index + t * r.slope) + 1e-3);
#endif
        for (; t < until && found.z < 0.5; t += step_length)
            found = take(found, value_on(r, t));
    }
    return found.z < 0.5 ? take(found, value_on(r, to)) : found;
}
#endif
#endif

// Goes along a part of a ray, after foresee().
vec4 along_part(ray r, vec2 part, vec4 found)
{
    if (part.x < part.y) {
#ifdef INSIDE
        found.w = none; // it follows on nothing
#endif
        found = foresee(r, part, found);
        found = along(r, part.x, part.y, found);
    }
    return found;
}

vec4 nothing()
{
#ifdef AVERAGE
    return vec4(0.0);
#endif
#ifdef MINIP
    return vec4(none, none, 0.0, none);
#endif
    return vec4(-none, 0.0, 0.0, -none);
}

// Returns a value's colour, opaque; in front of a mesh with the transfer function's opacity.
vec4 show(vec4 found, bool has_mesh)
{
#ifdef AVERAGE
    if (found.y == 0.0)
        return vec4(0.0);
    float value = found.x / found.y;
#else
    float value = found.x;
    if (abs(value) >= none)
        return vec4(0.0);
#endif
    vec4 row = classify(coordinate_of(rise * value));
    float alpha = has_mesh ? 1.0 - exp(-row.a) : 1.0;
    return vec4(row.rgb * alpha, alpha);
}

void main()
{
    vec2 all, kept;
    ray r = ray_of(gl_FragCoord.xy);
    intervals(r, all, kept);
#ifdef FIRST
    vec4 found = nothing();
#else
    vec4 found = texelFetch(before, ivec2(gl_FragCoord.xy), 0);
#endif
#ifdef CUT_AWAY
    bool is_cut = kept.x < kept.y;
    found = along_part(r, vec2(all.x, is_cut ? kept.x : all.y), found);
    if (is_cut)
        found = along_part(r, vec2(kept.y, all.y), found);
#else
    found = along_part(r, kept, found);
#endif
#ifdef LAST
#ifdef MESH
    result = show(found, mesh_distance(r) < 1e29);
#else
    result = show(found, false);
#endif
#else
    result = found;
#endif
}
