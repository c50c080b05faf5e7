// Ray casting [Upson1988, Drebin1988], front to back, in segments that are pre-integrated
// [Engel2001]; the last one ends where the ray does.
uniform sampler2D segments;
uniform usampler3D skip;
uniform float step_length;
out vec4 result;

const float segment_rows = 1024.0;

// What a segment of a length between two coordinates adds; NaN is empty.
vec4 segment_between(float front, float back, float extent)
{
    vec2 at = (clamp(vec2(front, back), 0.0, 1.0) * (segment_rows - 1.0) + 0.5) / segment_rows;
    vec4 full = texture(segments, at);
    if (!(front == front && back == back))
        return vec4(0.0);
    return full;
}

// The same stuff on another length, or more or less of it: light through it to that power.
vec4 stretch(vec4 color, float power)
{
    float alpha = 1.0 - pow(1.0 - min(color.a, 0.9999999), power);
    return color.a > 0.0 ? vec4(color.rgb * (alpha / color.a), alpha) : color;
}

// How far a ray goes from an empty block before it may meet something.
float leap_from(vec3 at, vec3 slope)
{
    ivec3 most = textureSize(skip, 0) - 1;
    ivec3 block = clamp(ivec3(at / 8.0), ivec3(0), most);
    int away = int(texelFetch(skip, block, 0).r);
    if (away == 0)
        return 0.0;
    vec3 low = vec3(block - away + 1) * 8.0, high = vec3(block + away) * 8.0;
    vec3 exits = mix((low - at) / slope, (high - at) / slope, greaterThan(slope, vec3(0.0)));
    exits = mix(exits, vec3(1e30), equal(slope, vec3(0.0)));
    return max(min(exits.x, min(exits.y, exits.z)), 0.0);
}

// Where the ray leaves the cell it enters at.
float cell_exit(vec3 at, vec3 slope)
{
    vec3 next = mix(ceil(at - 1e-4) - 1.0, floor(at + 1e-4) + 1.0, greaterThan(slope, vec3(0.0)));
    vec3 exits = mix((next - at) / slope, vec3(1e30), equal(slope, vec3(0.0)));
    return max(min(exits.x, min(exits.y, exits.z)), 1e-3);
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
    bool has_front = false;
    float shift = march.z > 0.5 ? random(gl_FragCoord.xy) * h : h;
    while (t < to && sum.a < march.y) {
        vec3 at = r.index + t * r.slope;
#ifdef SKIP
        float steps = floor(leap_from(at, r.slope) / h);
        if (steps >= 1.0) {
            t += steps * h;
            has_front = false;
            continue;
        }
#endif
#ifdef CELLS
        float extent = min(cell_exit(at, r.slope), to - t);
#else
        float extent = min(shift, to - t);
        shift = h;
#endif
        vec4 color;
#ifdef SEGMENTS
        if (!has_front)
            front = coordinate_of(texel_at(at));
        float back = coordinate_of(texel_at(at + extent * r.slope));
        color = segment_between(front, back, extent);
        front = back;
        has_front = true;
        if (extent != h)
            color = stretch(color, extent / h);
#else
        vec4 row = classify(coordinate_of(texel_at(at + 0.5 * extent * r.slope)));
        float alpha = 1.0 - exp(-row.a * extent);
        color = vec4(row.rgb * alpha, alpha);
#endif
#if defined(LIT) || defined(FACTOR)
        if (color.a > 1e-6) {
            vec3 gradient = gradient_at(at + 0.5 * extent * r.slope);
#ifdef FACTOR
            color = stretch(color, gradient_factor(gradient));
#endif
#ifdef LIT
            if (color.a > 0.0)
                color.rgb = shade(color.rgb / color.a, gradient, -r.direction) * color.a;
#endif
        }
#endif
        color = attenuate(color, -(t + 0.5 * extent) * r.direction.z, y);
        sum += (1.0 - sum.a) * color;
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
    result = vec4(0.0);
    if (counts.z == 0) {
        result = along(r, kept.x, kept.y, result, y);
    } else if (kept.x < kept.y) {
        result = along(r, all.x, kept.x, result, y);
        result = along(r, kept.y, all.y, result, y);
    } else {
        result = along(r, all.x, all.y, result, y);
    }
    if (result.a == 0.0)
        discard;
}
