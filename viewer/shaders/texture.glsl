// Integrates a ray's colour in a slab, within one brick's box: slices through 3D textures
// [Wilson1994], pre-integrated [Engel2001], shaded by gradients or by quantised gradients
// [VanGelder1996].
uniform sampler2D segments;
uniform sampler3D classes; // premultiplied: colour x extinction, extinction per unit
uniform usampler3D
    normals;              // each voxel's direction; bits: opposite, a boundary's cell; and the
                          // root of the gradient's length
uniform sampler2D shades; // shaded colours: a row for each direction, the last for none; of
                          // materials with their extinction
uniform sampler2D directions; // in eye space, as long as the longest gradient; the last is 0
uniform sampler1D materials;  // the column of a value
uniform vec3 box_low, box_high;
uniform float thickness;
in vec3 front, back;
in float front_depth;
out vec4 result;

float value_at(vec3 place)
{
#ifdef EXACT_FILTER
    return coordinate_of(texel_at(place * brick_size - 0.5 + brick_first));
#else
    return coordinate_of(texture(volume, place).r);
#endif
}

// Returns colour and opacity of a way through an extinction: C = (1 - e^-alpha) / alpha E, O =
// 1 - e^-alpha.
vec4 absorb(vec3 color, float alpha)
{
    float opacity = 1.0 - exp(-alpha);
    return vec4(color * opacity, opacity);
}

// Returns the segment's colour, premultiplied; it is empty without a value.
vec4 segment_between(vec3 from, vec3 to, float extent)
{
#ifdef SEGMENTS
    vec2 ends = vec2(value_at(from), value_at(to));
    ends += 2.0 / 3.0 * (value_at(0.5 * (from + to)) - 0.5 * (ends.x + ends.y));
    vec4 full = texture(segments, (clamp(ends, 0.0, 1.0) * (dim.w - 1.0) + 0.5) / dim.w);
    return ends.x + ends.y == ends.x + ends.y ? stretch(full, extent / thickness) : vec4(0.0);
#else
    vec4 row = classify(value_at(0.5 * (from + to)));
    return absorb(row.rgb, row.a * extent);
#endif
}

#ifdef SHADES
// Returns the row of a voxel in the table.
float row_of(uint direction)
{
    bool is_opposite = counts.w != 0 && (direction & 16384u) != 0u;
    return float(direction & 16383u) +
           (is_opposite ? 0.5 * float(textureSize(shades, 0).y) : 0.0);
}

#ifdef MATERIALS
// Returns the shaded colour of a direction and a value's material, and its extinction.
vec4 entry_of(float row, float coordinate)
{
    int count = textureSize(materials, 0);
    int at = int(clamp(coordinate, 0.0, 1.0) * float(count - 1) + 0.5);
    int column = int(texelFetch(materials, at, 0).r + 0.5);
    return isnan(coordinate) ? vec4(0.0) : texelFetch(shades, ivec2(column, int(row)), 0);
}
#else
// Returns the shaded colour of a direction and a value, and the value's extinction.
vec4 entry_of(float row, float coordinate)
{
    vec2 size = vec2(textureSize(shades, 0));
    float column = (clamp(coordinate, 0.0, 1.0) * (size.x - 1.0) + 0.5) / size.x;
    return vec4(texture(shades, vec2(column, (row + 0.5) / size.y)).rgb,
                classify(coordinate).a);
}
#endif

ivec3 voxel_near(vec3 place)
{
    return clamp(ivec3(floor(place * brick_size)), ivec3(0), ivec3(brick_size) - 1);
}

// Colours of the cell's eight voxels, as premultiplied emission and extinction, interpolated.
vec4 shaded_voxels(vec3 place)
{
    vec3 at = clamp(place * brick_size - 0.5, vec3(0.0), brick_size - 1.0);
    vec3 low = min(floor(at), max(brick_size - 2.0, 0.0)), s = at - low;
    vec4 sum = vec4(0.0);
    for (int n = 0; n < 8; n++) {
        ivec3 corner = ivec3(n & 1, n >> 1 & 1, n >> 2);
        ivec3 voxel = min(ivec3(low) + corner, ivec3(brick_size) - 1);
        vec3 share = mix(1.0 - s, s, vec3(corner));
        float coordinate = coordinate_of(texelFetch(volume, voxel, 0).r);
        vec4 entry = entry_of(row_of(texelFetch(normals, voxel, 0).r), coordinate);
        float extinction = entry.a * share.x * share.y * share.z;
        if (extinction > 0.0)
            sum += extinction * vec4(entry.rgb, 1.0);
    }
    return sum;
}

#ifdef DIRECTIONS
// Interpolates the quantised gradients of the cell's eight voxels, in eye space.
vec3 gradient_of_voxels(vec3 place)
{
    vec3 at = clamp(place * brick_size - 0.5, vec3(0.0), brick_size - 1.0);
    vec3 low = min(floor(at), max(brick_size - 2.0, 0.0)), s = at - low;
    vec3 sum = vec3(0.0);
    for (int n = 0; n < 8; n++) {
        ivec3 corner = ivec3(n & 1, n >> 1 & 1, n >> 2);
        ivec3 voxel = min(ivec3(low) + corner, ivec3(brick_size) - 1);
        vec3 share = mix(1.0 - s, s, vec3(corner));
        uvec2 found = texelFetch(normals, voxel, 0).rg;
        float root = float(found.g) / 65535.0;
        float size = share.x * share.y * share.z * root * root;
        vec3 direction = texelFetch(directions, ivec2(int(found.r & 16383u), 0), 0).xyz;
        sum += ((found.r & 16384u) != 0u ? -size : size) * direction;
    }
    return sum;
}
#endif

bool is_boundary(vec3 place)
{
    ivec3 cell = ivec3(floor(place * brick_size - 0.5));
    cell = clamp(cell, ivec3(0), max(ivec3(brick_size) - 2, 0));
    return texelFetch(normals, cell, 0).r >= 32768u;
}
#endif

// Unlit, or shaded by the table.
vec4 color_of(vec3 from, vec3 to, float extent)
{
    vec3 middle = 0.5 * (from + to);
#if defined(SHADES) && defined(BOUNDARY)
    if (!is_boundary(middle))
        return vec4(0.0);
#endif
#if defined(COLORS)
#ifdef SHADES
    vec4 mixed = shaded_voxels(middle);
#else
    vec4 mixed = texture(classes, middle);
#endif
    return mixed.a > 0.0 ? absorb(mixed.rgb / mixed.a, mixed.a * extent) : vec4(0.0);
#else
#ifdef MATERIALS
#ifdef DIRECTIONS
    float row = 0.0;
#else
    float row = row_of(texelFetch(normals, voxel_near(middle), 0).r);
#endif
    vec4 entry = entry_of(row, value_at(middle));
    vec4 color = absorb(entry.rgb, entry.a * extent);
#else
    vec4 color = segment_between(from, to, extent);
#if defined(SHADES) && !defined(DIRECTIONS)
    if (color.a > 0.0)
        color.rgb =
            entry_of(row_of(texelFetch(normals, voxel_near(middle), 0).r), value_at(middle))
                .rgb *
            color.a;
#endif
#endif
    return color;
#endif
}

// from and to: shares of the slab's thickness.
vec4 through(float from, float to, vec3 direction, float secant)
{
    vec3 a = mix(front, back, from), b = mix(front, back, to);
    if (!(from < to))
        return vec4(0.0);
    vec4 color = color_of(a, b, (to - from) * thickness * secant);
    float depth = front_depth + 0.5 * (from + to) * thickness;
    vec3 at = view.x > 0.5
                  ? direction * secant * depth
                  : vec3((2.0 * gl_FragCoord.xy / picture.xy - 1.0) * picture.zw, -depth);
#ifdef DIRECTIONS
    if (color.a > 0.0)
        color.rgb =
            shade_at(color.rgb / color.a, gradient_of_voxels(0.5 * (a + b)), -direction, at) *
            color.a;
#endif
#if (defined(LIT) && !defined(SHADES)) || defined(FACTOR)
    color = by_gradient(color, gradient_in(0.5 * (a + b)), -direction, at);
#endif
#ifdef CUE
    color = attenuate(color, front_depth + 0.5 * (from + to) * thickness,
                      gl_FragCoord.y / picture.y);
#endif
    return color;
}

void main()
{
    vec2 at = (2.0 * gl_FragCoord.xy / picture.xy - 1.0) * picture.zw * view.x;
    float secant = sqrt(1.0 + dot(at, at));
    vec3 direction = vec3(at, -1.0) / secant;
    vec3 way = back - front;
    way = mix(way, vec3(1e-20), lessThan(abs(way), vec3(1e-20)));
    vec3 x = (box_low - front) / way, y = (box_high - front) / way;
    vec3 near = min(x, y), far = max(x, y);
    vec2 all = vec2(max(max(near.x, near.y), max(near.z, 0.0)),
                    min(min(far.x, far.y), min(far.z, 1.0)));
#ifdef MESH
    ray r = ray_of(gl_FragCoord.xy);
    all.y = min(all.y, (mesh_distance(r) * -r.direction.z - front_depth) / thickness);
#endif
#ifdef CLIPS
    vec2 kept = all;
    vec3 place = vec3((2.0 * gl_FragCoord.xy / picture.xy - 1.0) * picture.zw, 0.0);
    place = view.x > 0.5 ? direction * secant * front_depth : place + direction * front_depth;
    for (int n = 0; n < counts.y; n++)
        kept = cut(kept, dot(clips[n].xyz, place) - clips[n].w,
                   dot(clips[n].xyz, direction) * secant * thickness);
    if (counts.z == 0) {
        result = through(kept.x, kept.y, direction, secant);
    } else if (kept.x < kept.y) {
        result = through(all.x, kept.x, direction, secant);
        result += (1.0 - result.a) * through(kept.y, all.y, direction, secant);
    } else {
        result = through(all.x, all.y, direction, secant);
    }
#else
    result = through(all.x, all.y, direction, secant);
#endif
}
