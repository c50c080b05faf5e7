// A plane through the volume, opaque where the volume has values, in a thin frame.
uniform vec4 plane; // eye space: n . p = w
uniform vec3 frame_color;
uniform float frame_width; // samples
out vec4 result;

const float slack = 1e-3; // of a voxel: a slice may lie in the volume's face

bool is_within(vec3 index, vec3 from, vec3 to)
{
    return all(greaterThanEqual(index, from - slack)) && all(lessThanEqual(index, to + slack));
}

// Returns how much of the sample the frame covers: inside, along the volume's faces.
float frame_here(vec3 index)
{
    vec3 dx = dFdx(index), dy = dFdy(index), slope = sqrt(dx * dx + dy * dy);
    vec3 off = min(index - low.xyz, high.xyz - index) / max(slope, 1e-12);
    off = mix(off, vec3(1e6), lessThan(slope, vec3(1e-5))); // the slice is along those faces
    return clamp(frame_width + 0.5 - min(off.x, min(off.y, off.z)), 0.0, 1.0);
}

void main()
{
    ray r = ray_of(gl_FragCoord.xy);
    float slope = dot(plane.xyz, r.direction);
    float t = (plane.w - dot(plane.xyz, r.origin)) / slope;
    vec3 p = r.origin + t * r.direction, index = r.index + t * r.slope;
    float frame = frame_here(index);
    vec3 from = mix(brick_first, low.xyz, lessThan(dim.xyz, vec3(1.5)));
    vec3 to = mix(brick_first + brick_size - 1.0, high.xyz, lessThan(dim.xyz, vec3(1.5)));
#ifdef CLIPS
    bool kept = true; // a slice in a plane that clips is drawn
    for (int n = 0; n < counts.y; n++)
        kept = kept && dot(clips[n].xyz, p) >= clips[n].w + (counts.z != 0 ? slack : -slack);
    if (kept == (counts.z != 0))
        discard;
#endif
    if (abs(slope) < 1e-6 || !is_within(index, from, to) || -p.z < view.y || -p.z > view.z)
        discard;
    float texel = texel_at(index);
    if (isnan(texel) && frame < 0.5)
        discard;
    vec3 color =
        mix(classify(coordinate_of(texel)).rgb, frame_color, isnan(texel) ? 1.0 : frame);
    vec4 there = projection * vec4(p, 1.0);
    gl_FragDepth = 0.5 * there.z / there.w + 0.5;
    result = attenuate(vec4(color, 1.0), -p.z, gl_FragCoord.y / picture.y);
}
