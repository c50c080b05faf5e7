// A part of the picture in which a slab is drawn, once for each slab of a layer, the farthest
// first. Texture coordinates on a slab's planes are linear over the picture.
layout(location = 0) in vec2 corner;              // samples
uniform vec3 plane_origin, plane_right, plane_up; // of the layer's nearest plane
uniform vec3 origin_step, right_step, up_step;    // from a plane to the next
uniform float layer_depth, layer_slabs, thickness;
out vec3 front, back; // texture coordinates
out float front_depth;

vec3 plane_place(float n, vec2 at)
{
    return plane_origin + n * origin_step + at.x * (plane_right + n * right_step) +
           at.y * (plane_up + n * up_step);
}

void main()
{
    vec2 place = 2.0 * corner / picture.xy - 1.0;
    float n = layer_slabs - 1.0 - float(gl_InstanceID);
    front = plane_place(n, place * picture.zw);
    back = plane_place(n + 1.0, place * picture.zw);
    front_depth = layer_depth + n * thickness;
    gl_Position = vec4(place, 0.0, 1.0);
}
