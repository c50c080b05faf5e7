// Ray casting [Upson1988, Drebin1988], front to back, a sample in the middle of each step; the
// last step ends where the ray does. SEGMENTS: steps are pre-integrated [Engel2001], over the
// range of values that the samples before and after tell; with CELLS, from face to face.
uniform sampler2D segments;
uniform usampler3D skip;
uniform float step_length;
uniform vec3 last_block; // of skip
out vec4 result;

// Returns scale and bias from a texel to its place in the texture of segments, which is
// clamped.
vec2 segment_scale()
{
    return vec2(texels.x * (dim.w - 1.0), texels.y * (dim.w - 1.0) + 0.5) / dim.w;
}

// Returns the colour of half a segment, straight; NaN is empty.
vec4 half_segment(float front, float back)
{
    vec4 color = stretch(textureLod(segments, vec2(front, back), 0.0), 0.5);
    return isnan(front + back) ? vec4(0.0) : color;
}

// Returns the colour that a full segment adds, with given values at its ends and its middle.
// Both ends are shifted by two thirds of the middle's height above their mean: so the mean is
// that of the parabola.
vec4 segment_through(float front, float middle, float back)
{
    float shift = (2.0 / 3.0) * (middle - 0.5 * (front + back));
    vec4 color = textureLod(segments, vec2(front, back) + shift, 0.0);
    if (isnan(shift)) {
        color = half_segment(front, middle);
        color += (1.0 - color.a) * half_segment(middle, back);
    }
    return color;
}

// Returns the colour that a step adds, with the given value in its middle, and those a step
// before and after, which may be NaN. Over the step the value changes by half their difference.
vec4 segment_around(float middle, float before, float after)
{
    float change = 0.25 * (after - before);
    change = isnan(change) ? 0.0 : change;
    vec4 color = textureLod(segments, vec2(middle - change, middle + change), 0.0);
    return isnan(middle) ? vec4(0.0) : color;
}

// Returns how far a ray goes through empty blocks, at most `most`.
float leap_from(ray r, vec3 from, float most)
{
    float way = 0.0;
    while (way < most) {
        vec3 at = from + way * r.slope;
        ivec3 block = ivec3(min(at * 0.25, last_block));
        float away = float(texelFetch(skip, block, 0).r);
        if (away == 0.0)
            break;
        vec3 middle = vec3(block) * 4.0 + 2.0;
        float reach = away * 4.0 - 2.0;
        way += box_exit(r, at, middle - reach, middle + reach) + 1e-3;
    }
    return way;
}

float random(vec2 at)
{
    uvec2 n = uvec2(at) * uvec2(1664525u, 22695477u) + 1013904223u;
    uint x = n.x ^ (n.y * 2654435761u);
    x = (x ^ (x >> 15)) * 2246822519u;
    x = (x ^ (x >> 13)) * 3266489917u;
    return float(x >> 8) / 16777216.0;
}

vec4 along(ray r, float from, float to, vec4 sum, float y)
{
    float h = step_length, t = from, before = 0.0, next = 0.0;
    bool has_before = false, may_leap = true;
#ifdef SEGMENTS
    vec2 scale = segment_scale();
#endif
#ifdef JITTER
    float first = random(gl_FragCoord.xy) * h;
#endif
    while (t < to && sum.a < limits.x) {
#ifdef SKIP
        if (may_leap) {
            float steps = floor(leap_from(r, r.index + t * r.slope, to - t) / h);
            if (steps >= 1.0) {
                t += steps * h;
                has_before = false;
                continue;
            }
        }
#endif
#ifdef CELLS
        float extent = min(cell_exit(r, r.index + t * r.slope), to - t);
#else
        float extent = min(h, to - t);
#ifdef JITTER
        extent = min(extent, first);
        first = h;
#endif
#endif
#if defined(SEGMENTS) && defined(CELLS)
        float front = has_before ? before : texel_on(r, t) * scale.x + scale.y;
        float middle = texel_on(r, t + 0.5 * extent) * scale.x + scale.y;
        before = texel_on(r, t + extent) * scale.x + scale.y;
        vec4 color = segment_through(front, middle, before);
#elif defined(SEGMENTS)
        float here = has_before ? next : texel_on(r, t + 0.5 * extent) * scale.x + scale.y;
        bool is_last = t + extent + 0.5 * h > to;
        next = is_last ? has_before ? 2.0 * here - before : here
                       : texel_on(r, t + extent + 0.5 * h) * scale.x + scale.y;
        vec4 color = segment_around(here, has_before ? before : 2.0 * here - next, next);
        before = here;
#endif
#ifdef SEGMENTS
        has_before = true;
        if (extent != h)
            color = stretch(color, extent / h);
#else
        vec4 row = classify(coordinate_of(texel_on(r, t + 0.5 * extent)));
        float alpha = 1.0 - exp(-row.a * extent);
        vec4 color = vec4(row.rgb * alpha, alpha);
#endif
#if defined(LIT) || defined(FACTOR)
        if ((1.0 - sum.a) * color.a > 1e-5) // others would not be seen
            color = by_gradient(color, gradient_on(r, t + 0.5 * extent), -r.direction,
                                r.origin + (t + 0.5 * extent) * r.direction);
#endif
#ifdef CUE
        color = attenuate(color, -(t + 0.5 * extent) * r.direction.z, y);
#endif
        sum += (1.0 - sum.a) * color;
        may_leap = color.a == 0.0;
        t += extent;
    }
    return sum;
}

void main()
{
    vec2 all, kept;
    ray r = ray_of(gl_FragCoord.xy);
    float y = gl_FragCoord.y / picture.y;
    intervals(r, all, kept);
#ifdef CUT_AWAY
    bool is_cut = kept.x < kept.y;
    result = along(r, all.x, is_cut ? kept.x : all.y, vec4(0.0), y);
    if (is_cut)
        result = along(r, kept.y, all.y, result, y);
#else
    result = along(r, kept.x, kept.y, vec4(0.0), y);
#endif
    if (result.a == 0.0)
        discard;
}
