// Ray casting [Upson1988, Drebin1988], front to back, in segments that are pre-integrated
// [Engel2001]; the last one ends where the ray does.
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
    float h = step_length, t = from, front = 0.0;
    bool has_front = false, may_leap = true;
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
                has_front = false;
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
#ifdef SEGMENTS
        if (!has_front)
            front = texel_on(r, t) * scale.x + scale.y;
        float middle = texel_on(r, t + 0.5 * extent) * scale.x + scale.y;
        float back = texel_on(r, t + extent) * scale.x + scale.y;
        vec4 color = segment_through(front, middle, back);
        front = back;
        has_front = true;
        if (extent != h)
            color = stretch(color, extent / h);
#else
        vec4 row = classify(coordinate_of(texel_on(r, t + 0.5 * extent)));
        float alpha = 1.0 - exp(-row.a * extent);
        vec4 color = vec4(row.rgb * alpha, alpha);
#endif
#if defined(LIT) || defined(FACTOR)
        if ((1.0 - sum.a) * color.a > 1e-5) // others would not be seen
            color = by_gradient(color, gradient_on(r, t + 0.5 * extent), -r.direction);
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
