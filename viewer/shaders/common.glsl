// Uniforms and functions of all shaders. See viewer/scene/frame_setup.h for the spaces.
layout(std140) uniform Frame
{
    mat4 projection;
    mat4 eye_from_index, index_from_eye;
    mat4 gradient_to_eye; // of a gradient per voxel, to one per unit
    vec4 picture;         // width, height, half x, half y
    vec4 view;            // 1 in perspective, near, far, depth cue
    vec4 cue_range;       // start and end of the depth cue, decay per unit if it is exponential
    vec4 low, high;       // the volume in index space
    vec4 dim;             // samples; rows of the pre-integrated table
    vec4 texels;          // scale and bias from a texel to a table's coordinate
    vec4 limits;          // opacity to stop at, factor's end, 1 / gradient of a full surface,
                          // bits of the clips that are faces
    vec4 material;        // ambient, diffuse, specular, shininess
    vec4 light_direction[4], light_color[4];
    vec4 background[2]; // top, bottom
    vec4 clips[12];     // eye space: n . p >= w is kept
    ivec4 counts;       // lights, clips, 1: clips cut away, 1: lit on one side
};

// Values of one brick. IN_PLACE: the voxels themselves, x fastest, as the processor that draws
// finds them in memory.
#ifndef IN_PLACE
uniform sampler3D volume;
#elif defined(SHORTS)
uniform isamplerBuffer volume;
#else
uniform samplerBuffer volume;
#endif
uniform ivec3
    voxel_steps; // IN_PLACE: from a voxel to the next along each axis that has more than one
uniform vec3 last_cell;
uniform sampler3D gradients;          // and gradients per voxel, and shadows
uniform sampler1D table;              // transfer function: colour, extinction per unit
uniform sampler1D factor;             // of the extinction, by the gradient's length
uniform vec3 brick_first, brick_size; // samples
const float table_rows = 4096.0, factor_rows = 1024.0;

vec3 brick_place(vec3 index)
{
    return (index - brick_first + 0.5) / brick_size;
}

// Returns the texel at a point of index space, interpolated; NaN where a sample around it has
// no value.
#ifdef IN_PLACE
float voxel(int n)
{
#ifdef SHORTS
    return (float(texelFetch(volume, n).r) + 32768.0) / 65535.0;
#else
    return texelFetch(volume, n).r;
#endif
}

// Returns the texel at a point of the volume; rounding may have put it a little outside.
float texel_inside(vec3 index)
{
    ivec3 i = ivec3(min(index, last_cell));
    vec3 s = index - vec3(i);
    int n = i.x + i.y * voxel_steps.y + i.z * voxel_steps.z;
    int m = n + voxel_steps.z;
    vec4 low = vec4(voxel(n), voxel(n + voxel_steps.y), voxel(m), voxel(m + voxel_steps.y));
    n += voxel_steps.x;
    m += voxel_steps.x;
    vec4 high = vec4(voxel(n), voxel(n + voxel_steps.y), voxel(m), voxel(m + voxel_steps.y));
    low += s.x * (high - low);
    low.xz += s.y * (low.yw - low.xz);
    return low.x + s.z * (low.z - low.x);
}

float texel_at(vec3 index)
{
    return texel_inside(clamp(index, vec3(0.0), brick_size - 1.0));
}
#else
float texel_at(vec3 index)
{
#ifdef EXACT_FILTER
    vec3 at = clamp(index - brick_first, vec3(0.0), brick_size - 1.0);
    vec3 low = min(floor(at), max(brick_size - 2.0, 0.0)), s = at - low;
    ivec3 i = ivec3(low), j = ivec3(min(low + 1.0, brick_size - 1.0));
    vec4 x0 = vec4(texelFetch(volume, i, 0).r, texelFetch(volume, ivec3(i.x, j.y, i.z), 0).r,
                   texelFetch(volume, ivec3(i.xy, j.z), 0).r,
                   texelFetch(volume, ivec3(i.x, j.yz), 0).r);
    vec4 x1 = vec4(texelFetch(volume, ivec3(j.x, i.yz), 0).r,
                   texelFetch(volume, ivec3(j.xy, i.z), 0).r,
                   texelFetch(volume, ivec3(j.x, i.y, j.z), 0).r, texelFetch(volume, j, 0).r);
    vec4 x = mix(x0, x1, s.x);
    vec2 y = mix(x.xz, x.yw, s.y);
    return mix(y.x, y.y, s.z);
#else
    return textureLod(volume, brick_place(index), 0.0).r;
#endif
}
#endif

// Does the same at a place in the brick's texture.
float texel_in(vec3 place)
{
#ifdef IN_PLACE
    return texel_at(place * brick_size - 0.5);
#else
    return textureLod(volume, place, 0.0).r;
#endif
}

// Returns a texel's coordinate in the table: 0 at its first value, 1 at its last.
float coordinate_of(float texel)
{
    return texel * texels.x + texels.y;
}

// Returns colour and extinction at a coordinate; NaN has none.
vec4 classify(float coordinate)
{
    float at = clamp(coordinate, 0.0, 1.0);
    vec4 row = textureLod(table, (at * (table_rows - 1.0) + 0.5) / table_rows, 0.0);
    return isnan(coordinate) ? vec4(0.0) : row;
}

#if defined(SHADOW) || defined(OCCLUSION)
float shadow; // fraction of the light, where gradient_in() was called last
#endif

// Returns the gradient at a place in the brick's texture, in eye space, per unit. Differences
// of interpolated values equal interpolated differences of voxels.
vec3 gradient_in(vec3 place)
{
#ifdef DIFFERENCES
    vec3 voxel = 1.0 / brick_size, first = 0.5 * voxel, last = 1.0 - first;
    vec3 low = max(place - voxel, first), high = min(place + voxel, last);
    vec3 rise =
        vec3(texel_in(vec3(high.x, place.yz)) - texel_in(vec3(low.x, place.yz)),
             texel_in(vec3(place.x, high.y, place.z)) - texel_in(vec3(place.x, low.y, place.z)),
             texel_in(vec3(place.xy, high.z)) - texel_in(vec3(place.xy, low.z)));
    vec3 apart = max((high - low) * brick_size, 0.5);
    return mat3(gradient_to_eye) * (rise * texels.z / apart);
#else
    vec4 texel = textureLod(gradients, place, 0.0);
#if defined(SHADOW) || defined(OCCLUSION)
    shadow = texel.w;
#endif
    return mat3(gradient_to_eye) * texel.xyz;
#endif
}

vec3 gradient_at(vec3 index)
{
    return gradient_in(brick_place(index));
}

// Returns the factor by which the transfer function multiplies the extinction, by the gradient.
float gradient_factor(vec3 gradient)
{
    float at = clamp(length(gradient) / limits.y, 0.0, 1.0);
    return textureLod(factor, (at * (factor_rows - 1.0) + 0.5) / factor_rows, 0.0).r;
}

// Shades a colour, on both sides or on that of lower values; to_eye and the gradient are in eye
// space. Without a gradient: ambient light. Surfaces of indices reflect by their strength.
vec3 shade(vec3 color, vec3 gradient, vec3 to_eye)
{
    float size2 = dot(gradient, gradient);
    vec3 n = gradient * (size2 > 0.0 ? inversesqrt(size2) : 0.0);
    float strength = limits.z > 0.0 ? min(sqrt(size2) * limits.z, 1.0) : 1.0;
    vec3 light = material.x * color;
    for (int i = 0; i < counts.x; i++) {
        vec3 l = light_direction[i].xyz, h = l + to_eye;
        float facing = -dot(n, l);
        float diffuse = counts.w != 0 ? max(facing, 0.0) : abs(facing);
        float specular = 0.0;
        if (material.z > 0.0 && (counts.w == 0 || facing > 0.0)) {
            float near = abs(dot(n, h)) * inversesqrt(max(dot(h, h), 1e-20));
            specular = near > 0.0 ? pow(near, material.w) : 0.0;
        }
        float lit = strength;
#ifdef SHADOW
        lit *= i == 0 ? shadow : 1.0;
#endif
        light +=
            lit * light_color[i].rgb * (material.y * diffuse * color + material.z * specular);
    }
    return light;
}

#ifdef CLIPS
// Finds the face that clip planes cut near a point in eye space: its normal, and its share of
// the light there, 1 within a unit of it and 0 beyond two.
vec4 clip_face(vec3 at)
{
    vec4 face = vec4(0.0, 0.0, 0.0, 1e30);
    for (int n = 0; n < counts.y; n++) {
        float d = dot(clips[n].xyz, at) - clips[n].w;
        face = d < face.w && (int(limits.w) >> n & 1) != 0 ? vec4(clips[n].xyz, d) : face;
    }
    return vec4(counts.z > 0 ? -face.xyz : face.xyz, clamp(2.0 - abs(face.w), 0.0, 1.0));
}
#endif

// Shades a colour at a point in eye space: by the gradient, and close to clip planes by these,
// since a cut through a solid has no gradient. Cuts have no highlights, which would cover them
// whole.
vec3 shade_at(vec3 color, vec3 gradient, vec3 to_eye, vec3 at)
{
    vec3 light = shade(color, gradient, to_eye);
#ifdef CLIPS
    vec4 face = clip_face(at);
    vec3 cut = material.x * color;
    for (int i = 0; i < counts.x; i++) {
        float facing = -dot(face.xyz, light_direction[i].xyz);
#ifdef SHADOW
        facing *= i == 0 ? shadow : 1.0;
#endif
        cut += light_color[i].rgb * material.y *
               (counts.w != 0 ? max(facing, 0.0) : abs(facing)) * color;
    }
    light = mix(light, cut, face.w);
#endif
    return light;
}

// Changes a colour to the same material over another length, or in another density: its
// transmitted light is raised to that power.
vec4 stretch(vec4 color, float power)
{
    float alpha = 1.0 - pow(1.0 - min(color.a, 0.9999999), power);
    return color.a > 0.0 ? vec4(color.rgb * (alpha / color.a), alpha) : vec4(0.0);
}

// Changes a premultiplied colour by the gradient: more or less of it, and light on it. SHADES:
// it is lit already. at: in eye space.
vec4 by_gradient(vec4 color, vec3 gradient, vec3 to_eye, vec3 at)
{
#ifdef FACTOR
    color = stretch(color, gradient_factor(gradient));
#endif
#if defined(LIT) && !defined(SHADES)
    if (color.a > 0.0)
        color.rgb = shade_at(color.rgb / color.a, gradient, to_eye, at) * color.a;
#ifdef OCCLUSION
    color.rgb *= shadow;
#endif
#endif
    return color;
}

// Returns the fraction of its own light that something at a depth keeps.
float cue(float depth)
{
    if (cue_range.z > 0.0)
        return exp(-cue_range.z * max(depth - cue_range.x, 0.0));
    return 1.0 - view.w * clamp((depth - cue_range.x) / (cue_range.y - cue_range.x), 0.0, 1.0);
}

// y: 0 at the picture's bottom, 1 at its top.
vec3 background_at(float y)
{
    return mix(background[1].rgb, background[0].rgb, y);
}

// Replaces some of a premultiplied colour by the background's.
vec4 attenuate(vec4 color, float depth, float y)
{
    return vec4(mix(color.a * background_at(y), color.rgb, cue(depth)), color.a);
}

#if defined(RAYS) && defined(FRAGMENT)
uniform sampler2D depth; // of the mesh, 1: none

struct ray {
    vec3 origin, direction; // eye space
    vec3 index, slope;      // the same in index space
    vec3 inverse, ahead;    // 1 / slope; 1: upward along that axis, or not along it
    vec3 place, way;        // origin and direction in the brick's texture
};

ray ray_of(vec2 fragment)
{
    vec2 at = (2.0 * fragment / picture.xy - 1.0) * picture.zw;
    ray r;
    r.origin = view.x > 0.5 ? vec3(0.0) : vec3(at, 0.0);
    r.direction = view.x > 0.5 ? normalize(vec3(at, -1.0)) : vec3(0.0, 0.0, -1.0);
    r.index = (index_from_eye * vec4(r.origin, 1.0)).xyz;
    r.slope = mat3(index_from_eye) * r.direction;
    r.inverse = mix(1.0 / r.slope, vec3(1e30), equal(r.slope, vec3(0.0)));
    r.ahead = vec3(greaterThanEqual(r.slope, vec3(0.0)));
    r.place = brick_place(r.index);
    r.way = r.slope / brick_size;
    return r;
}

// Return texel_at() and gradient_at() of a point of a ray.
float texel_on(ray r, float t)
{
#if defined(IN_PLACE)
    return texel_inside(r.index + t * r.slope);
#elif defined(EXACT_FILTER)
    return texel_at(r.index + t * r.slope);
#else
    return texel_in(r.place + t * r.way);
#endif
}

vec3 gradient_on(ray r, float t)
{
    return gradient_in(r.place + t * r.way);
}

// Returns how far a ray goes from a point in a box of index space to where it leaves the box.
float box_exit(ray r, vec3 at, vec3 low, vec3 high)
{
    vec3 exits = (mix(low, high, r.ahead) - at) * r.inverse;
    return max(min(exits.x, min(exits.y, exits.z)), 0.0);
}

// Returns how far it goes to where it leaves the cell that it is in, or enters.
float cell_exit(ray r, vec3 at)
{
    vec3 next = mix(ceil(at - 1e-4) - 1.0, floor(at + 1e-4) + 1.0, r.ahead);
    return max(box_exit(r, at, next, next), 1e-3);
}

// Cuts an interval to where at + t slope >= 0.
vec2 cut(vec2 t, float at, float slope)
{
    float hit = -at / slope;
    if (slope > 0.0)
        t.x = max(t.x, hit);
    else if (slope < 0.0)
        t.y = min(t.y, hit);
    else if (at < 0.0)
        t.y = t.x - 1.0;
    return t;
}

// Returns the distance of the mesh along the ray.
float mesh_distance(ray r)
{
    float z = texelFetch(depth, ivec2(gl_FragCoord.xy), 0).r;
    if (z >= 1.0)
        return 1e30;
    float ndc = 2.0 * z - 1.0, n = view.y, f = view.z;
    float d =
        view.x > 0.5 ? 2.0 * f * n / (f + n - ndc * (f - n)) : (ndc * (f - n) + f + n) / 2.0;
    return d / -r.direction.z;
}

// Finds the part of a ray in the brick, in front of the mesh, and the part of that which clip
// planes keep.
void intervals(ray r, out vec2 all, out vec2 kept)
{
    vec3 box_low = max(low.xyz, mix(brick_first, low.xyz, lessThan(dim.xyz, vec3(1.5))));
    vec3 box_high = min(
        high.xyz, mix(brick_first + brick_size - 1.0, high.xyz, lessThan(dim.xyz, vec3(1.5))));
    all = vec2(view.x > 0.5 ? view.y / -r.direction.z : -1e30, 1e30);
#ifdef MESH
    all.y = mesh_distance(r);
#endif
    vec3 enter = (mix(box_high, box_low, r.ahead) - r.index) * r.inverse;
    vec3 leave = (mix(box_low, box_high, r.ahead) - r.index) * r.inverse;
    bvec3 is_beside =
        bvec3(vec3(equal(r.slope, vec3(0.0))) *
              max(vec3(lessThan(r.index, box_low)), vec3(greaterThan(r.index, box_high))));
    all.x = max(all.x, max(enter.x, max(enter.y, enter.z)));
    all.y = any(is_beside) ? all.x : min(all.y, min(leave.x, min(leave.y, leave.z)));
    kept = all;
#ifdef CLIPS
    for (int n = 0; n < counts.y; n++)
        kept =
            cut(kept, dot(clips[n].xyz, r.origin) - clips[n].w, dot(clips[n].xyz, r.direction));
#endif
}
#endif
