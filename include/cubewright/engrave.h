/* Text on solids: engraved into them, or raised on them. */
#ifndef CUBEWRIGHT_ENGRAVE_H
#define CUBEWRIGHT_ENGRAVE_H

#include <cubewright/mesh.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Maximum of the characters of a text. */
#define CW_ENGRAVE_CHARACTERS 400

/* Text, and the place that it goes to. Zero-initialise the struct and set what you need; a zero field means the
 * default named beside it. */
typedef struct cw_engrave_desc {
    uint32_t version; /* 0: the first version of this struct */
    const char *
        text; /* UTF-8, one line: letters, digits and signs of ASCII, and some others; required */
    double
        size_mm; /* height of capitals; default: as large as fits, up to a tenth of the mesh's diagonal */
    double
        depth_mm; /* of the letters, or their height with emboss; default: an eighth of the size */
    double stroke_mm; /* width of strokes; default: a seventh of the size */
    double
        wall_mm; /* minimum of material behind the letters; default: 0.8, or twice the depth if that is less */
    bool emboss; /* default: the text is cut into the solid; else it stands out */
    bool has_at; /* default: on the flattest place that is large enough */
    double at
        [3]; /* with has_at: the text's middle is on the surface next to this point; world, mm */
    double direction
        [3]; /* out of the solid, toward the reader; default: the normal of the surface. Without has_at, only
                            places within 30 degrees of it count */
    int threads;          /* default: one per processor; the result does not depend on it */
    cw_progress progress; /* default: none */
} cw_engrave_desc;

/* Facts on the text and its place. World, mm. */
typedef struct cw_engrave_facts {
    uint32_t version; /* 0: the first version of this struct */
    double center[3]; /* on the surface, or on the plane that is fitted to it */
    double normal[3]; /* of length 1, toward the reader; the letters go along it */
    double right[3];  /* of length 1: direction of reading */
    double size_mm;   /* height of capitals */
    double stroke_mm; /* width of strokes */
    double depth_mm;  /* or height */
    double wall_mm;   /* minimum of material that was requested */
    double width_mm;  /* of the whole text */
    double height_mm; /* the same */
    double
        deviation_mm; /* largest distance of the surface from the fitted plane, in the box of the text */
    double lean_deg; /* largest angle between the surface and that plane */
    double
        thickness_mm; /* the thinnest wall behind the text, with the depth; INFINITY: none was met */
    double volume_mm3; /* of the letters: removed or added */
    size_t characters; /* without spaces */
} cw_engrave_facts;

/* Engraves a text into a solid, or raises it.
 *
 * Letters are strokes with round ends, of a font of lines. Their floor follows the surface: each point of it is the
 * depth below the surface, along one direction. On flat places it is flat. The result is that of
 * cw_mesh_boolean(): a closed manifold that does not cross itself. The place is a rectangle around the text, with a
 * margin of a quarter of the size, in which the surface is one piece, leans by up to 50 degrees, has room in
 * front of it, and is thick enough. Of several places of the same flatness, large plane ones come first, and those
 * that face down last. Text stands upright (z is up), or runs along the longer side of places that lie flat.
 *
 * Vertices of the mesh keep their place and their attributes. Normals are those of the new triangles, and part at the
 * edges of the letters.
 *
 * mesh     borrowed; closed
 * desc     borrowed
 * out      filled on success, emptied on failure; free it with cw_mesh_free()
 * facts    may be NULL
 *
 * Returns  CW_ERR_ARGUMENT  the text is empty, too long or has characters that the font has not (they are named); a
 *                           length is negative, not finite, or does not go with the others; or as cw_mesh_check()
 *          CW_ERR_EMPTY     the mesh encloses nothing
 *          CW_ERR_CHECK     no place is large, flat and thick enough: the message has the size that fits, if there is
 *                           one; or as cw_mesh_boolean()
 *          CW_ERR_LIMIT; CW_ERR_NO_MEMORY; CW_ERR_CANCELLED
 * Cost     near-linear: a pass over the triangles, some 100,000 rays, and a boolean
 * Threads  reentrant; the same to the bit for any number of threads
 * Source   rays [Moeller1997]; outlines of a distance field as [Lorensen1987] */
CW_NODISCARD CW_API cw_status cw_mesh_engrave(const cw_mesh *mesh, const cw_engrave_desc *desc,
                                              cw_mesh *out, cw_engrave_facts *facts,
                                              cw_error *err);

#ifdef __cplusplus
}
#endif

#endif
