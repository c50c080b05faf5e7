// Draws by coherent projection [Wilhelms1991]: polygons over which the places where rays enter
// and leave a cell, or in perspective their reciprocal depths, are linear. See
// viewer/modes/projected_cells.h.
#ifdef VERTEX
layout(
    location = 0) in vec4 place; // of the picture, -1 to 1; front depth, back minus front; in
                                 // perspective 1 / front depth, and minus 1 / back depth
layout(
    location = 1) in vec3 values; // coordinates in the table, in perspective over the depths;
                                  // the largest difference of depths in the cell
out vec2 spans, ends;
flat out float most;
out vec4 linear;

// Returns the opacity in the form of 1991: of the path through the cell, by the mean of its
// ends.
vec4 opacity_of(vec2 at)
{
    float w = place.z, back = w - place.w;
    float slant = view.x > 0.5 ? length(vec3(at * picture.zw, 1.0)) : 1.0;
    float extent = view.x > 0.5 ? place.w / (w * back) * slant : place.w;
    vec2 value = view.x > 0.5 ? values.xy / vec2(w, back) : values.xy;
    vec4 row = 0.5 * (classify(value.x) + classify(value.y));
    float alpha = 1.0 - exp(-row.a * extent);
    return vec4(row.rgb * alpha, alpha);
}

void main()
{
    spans = place.zw;
    ends = values.xy;
    most = values.z;
#ifdef LINEAR
    linear = opacity_of(place.xy);
#else
    linear = vec4(0.0);
#endif
    gl_Position = vec4(place.xy, 0.0, 1.0);
}
#else
uniform sampler2D segments;
uniform float step_length;
in vec2 spans, ends;
flat in float most;
in vec4 linear;
out vec4 result;

// A ray's way through the cell: distances along the ray, and the values there.
struct way {
    float from, extent, front, back;
};

vec4 segment_between(float front, float back, float extent)
{
    vec2 at = (clamp(vec2(front, back), 0.0, 1.0) * (dim.w - 1.0) + 0.5) / dim.w;
    return extent > 0.0 ? stretch(texture(segments, at), extent / step_length) : vec4(0.0);
}

vec4 over(vec4 front, vec4 back)
{
    return front + (1.0 - front.a) * back;
}

// Returns the colour that a part of the way adds, over which the value is linear. Beyond the
// table's ends its last value continues: those parts have one value each.
vec4 between(float front, float back, float extent)
{
#ifdef SEGMENTS
    float span = back - front;
    vec2 inside = vec2(0.0, 1.0);
    if (min(front, back) < 0.0 || max(front, back) > 1.0)
        inside = abs(span) < 1e-9
                     ? vec2(0.0, 0.0)
                     : clamp(((span > 0.0 ? vec2(0.0, 1.0) : vec2(1.0, 0.0)) - front) / span,
                             0.0, 1.0);
    vec4 color = segment_between(front, back, (inside.y - inside.x) * extent);
    if (inside.x > 0.0)
        color = over(segment_between(front, front, inside.x * extent), color);
    if (inside.y < 1.0)
        color = over(color, segment_between(back, back, (1.0 - inside.y) * extent));
    return color;
#else
    vec4 row = classify(0.5 * (front + back));
    float alpha = 1.0 - exp(-row.a * extent);
    return vec4(row.rgb * alpha, alpha);
#endif
}

// Returns the colour that the part from t.x to t.y adds; distances along the ray.
vec4 along(ray r, way w, vec2 t, float y)
{
    if (!(t.y > t.x))
        return vec4(0.0);
    vec2 share = (t - w.from) / w.extent;
    float middle = 0.5 * (t.x + t.y);
#ifdef LINEAR
    vec4 color = linear * (share.y - share.x);
#else
    vec4 color =
        between(mix(w.front, w.back, share.x), mix(w.front, w.back, share.y), t.y - t.x);
#endif
#if defined(LIT) || defined(FACTOR)
    if (color.a > 1e-6)
        color = by_gradient(color, gradient_at(r.index + middle * r.slope), -r.direction,
                            r.origin + middle * r.direction);
#endif
    return attenuate(color, -middle * r.direction.z, y);
}

// Finds the way through the cell. Polygons are rasterised on a grid: where a sliver is narrower
// than that, linear values continue beyond its ends. Cut off at both ends, the parts of two
// neighbours still add up.
way way_of(ray r)
{
    bool slanted = view.x > 0.5;
    float back = spans.x - spans.y, scale = 1.0 / -r.direction.z;
    way w;
    w.from = (slanted ? 1.0 / spans.x : spans.x) * scale;
    w.extent = clamp(slanted ? spans.y / (spans.x * back) : spans.y, 0.0, most) * scale;
    w.front = slanted ? ends.x / spans.x : ends.x;
    w.back = slanted ? ends.y / back : ends.y;
    return w;
}

void main()
{
    ray r = ray_of(gl_FragCoord.xy);
    way w = way_of(r);
    float y = gl_FragCoord.y / picture.y;
    vec2 all = vec2(w.from, min(w.from + w.extent, mesh_distance(r))), kept = all;
    for (int n = 0; n < counts.y; n++)
        kept =
            cut(kept, dot(clips[n].xyz, r.origin) - clips[n].w, dot(clips[n].xyz, r.direction));
    if (counts.z == 0 || counts.y == 0) {
        result = along(r, w, kept, y);
    } else if (kept.x < kept.y) {
        result = along(r, w, vec2(all.x, kept.x), y);
        result = over(result, along(r, w, vec2(kept.y, all.y), y));
    } else {
        result = along(r, w, all, y);
    }
    if (!(result.a > 0.0))
        discard;
}
#endif
