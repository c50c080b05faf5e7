/* Verdicts: judges the measurements of a mesh against a profile, the purpose of the mesh. */
#ifndef CUBEWRIGHT_CHECK_H
#define CUBEWRIGHT_CHECK_H

#include <cubewright/appearance.h>
#include <cubewright/distance.h>
#include <cubewright/print.h>
#include <cubewright/quality.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The purpose of a mesh, and with it the properties that must hold. */
typedef enum cw_profile {
    CW_PROFILE_BASIC, /* an oriented 2-manifold without flaws, open or closed */
    CW_PROFILE_PRINT, /* basic, closed, free of crossings, and of a size that printers can make
                       */
    CW_PROFILE_WEB,   /* to be looked at: it faces outward, has normals, and keeps its budget */
    CW_PROFILE_FEM,   /* print without the size; angles and shapes that simulations can use */
    CW_PROFILE_GAME,  /* as for the web, with the budget of a game's asset */
    CW_PROFILE_MOBILE, /* the same for telephones and headsets */
} cw_profile;

/* Limits of the profiles: sizes of a print; shapes for FEM. See cw_check_budget(), too. */
#define CW_PRINT_MIN_MM      5.0
#define CW_PRINT_MAX_MM      400.0
#define CW_FEM_MIN_ANGLE_DEG 10.0
#define CW_FEM_MAX_ASPECT    10.0

/* Measurements of one mesh, each made by the call named beside it. A NULL means "not measured".
 * Verdicts that need it are then left out, or are unknown where the profile asks for them. */
typedef struct cw_findings {
    const cw_quality *quality;     /* cw_quality_measure(), welded, with shells; required */
    const cw_crossings *crossings; /* cw_self_intersections() */
    const cw_cgal_facts *cgal;     /* cw_quality_ask_cgal() */
    const cw_print_facts *print;   /* cw_print_measure() */
    const cw_distance *to_field;   /* cw_distance_to_field() */
    const cw_distance *from_field; /* cw_distance_to_mesh() from the field's own surface */
    const cw_quality *field;       /* cw_quality_measure() of the field's own surface */
    size_t missing; /* components of that surface with nothing of the mesh near them; from_field
                       is without them */
    double missing_mm3, missing_mm; /* volume that the largest encloses; how far the mesh is
                                       from one */
    const cw_distance *to_reference, *from_reference; /* cw_distance_to_mesh() both ways */
    double tolerance_mm;    /* for the distances; 0: no limit, distances are only reported */
    bool has_normals;       /* the mesh has normals */
    const char *file_fault; /* cw_mesh_file.fault of the file; NULL or "": none */
    size_t file_bytes;      /* of the file; 0: not known */
    const cw_appearance *looks;      /* cw_appearance_measure() beside the reference, and */
    const cw_appearance *bare_looks; /* the same without maps, if there are some */
    double max_delta_e;              /* limit of their mean CIEDE2000; 0: none */
    double min_psnr_db;              /* limit of their PSNR; 0: none */
    const cw_orient_facts *orient;   /* cw_orient_print() */
} cw_findings;

enum { CW_BUDGET_LEVELS = 4 }; /* maximum of levels of detail in a budget */

/* The budget of a mesh that is drawn. */
typedef struct cw_budget {
    size_t triangles[CW_BUDGET_LEVELS]; /* of each level of detail, falling; 0: there is none */
    uint32_t texture_size;              /* texels along each side of its textures */
    size_t file_bytes;                  /* of its file */
} cw_budget;

/* Returns the budget of a profile, which cw_check_judge() holds a mesh against; static. NULL: the profile has
 * none.
 * profile  any number */
CW_API const cw_budget *cw_check_budget(cw_profile profile);

/* Grades, from the worst to the best. */
typedef enum cw_grade {
    CW_GRADE_FAIL,    /* the profile's promise does not hold */
    CW_GRADE_UNKNOWN, /* the profile asks for it, and it was not or could not be decided */
    CW_GRADE_WARN,    /* holds, but look at it */
    CW_GRADE_OK,
    CW_GRADE_NOTE, /* not promised; for information */
} cw_grade;

/* A judgement of one property. */
typedef struct cw_verdict {
    const char *name;   /* "closed"; static */
    cw_grade grade;     /* how it stands */
    double number;      /* the count or measure behind it */
    char text[200];     /* one line for people */
    const char *advice; /* what to do about it; NULL: nothing. Static */
} cw_verdict;

enum { CW_MAX_VERDICTS = 32 }; /* maximum of cw_check_judge() */

/* Returns true if a profile asks for cw_self_intersections(); without it the verdict is
 * unknown. */
CW_API bool cw_check_wants_crossings(cw_profile profile);

/* Judges the findings. Returns the number of verdicts written, the worst first.
 * findings  borrowed
 * verdicts  filled with up to CW_MAX_VERDICTS */
CW_API size_t cw_check_judge(const cw_findings *findings, cw_profile profile,
                             cw_verdict verdicts[CW_MAX_VERDICTS]);

/* Returns true if no verdict is a failure or unknown.
 * verdicts  count of them, from cw_check_judge() */
CW_API bool cw_check_holds(const cw_verdict *verdicts, size_t count);

/* Returns "fail", "unknown", "warn", "ok" or "note".
 * grade  a grade */
CW_API const char *cw_grade_name(cw_grade grade);

/* How parts of one mesh meet: the surfaces of labels, or other solids that share interfaces. */
typedef struct cw_contacts {
    size_t triangles; /* of all parts */
    size_t shared; /* places of a triangle that two parts have, seen from opposite sides: their
                           interface */
    size_t overlapping; /* places where two parts or more see a triangle from the same side */
    size_t neighbours;  /* pairs of parts that share triangles */
} cw_contacts;

/* Finds the triangles that parts share. Corners are alike where their positions are equal.
 *
 * mesh      of all parts, merged
 * part_of   triangle_count numbers of parts
 * contacts  filled on success
 * once      set to the mesh with each shared triangle once, without attributes, to look for
 *           intersections between parts; may be NULL. Free it with cw_mesh_free()
 * Returns   CW_ERR_ARGUMENT as cw_mesh_check(); CW_ERR_LIMIT: more than 2^32 / 3 triangles;
 *           CW_ERR_NO_MEMORY
 * Cost      n log n triangles */
CW_NODISCARD CW_API cw_status cw_contacts_find(const cw_mesh *mesh, const uint32_t *part_of,
                                               cw_contacts *contacts, cw_mesh *once,
                                               cw_error *err);

/* A colour (red, green, blue) for each defect, for cw_check_paint(). */
typedef struct cw_paint {
    cw_defect defect;         /* the defect that it shows */
    const char *name, *color; /* "open edges", "red"; static */
    uint8_t rgb[3];           /* sRGB */
} cw_paint;

/* Returns the paints by priority: the first one wins where a triangle has several defects. */
CW_API const cw_paint *cw_check_paints(size_t *count);

/* Makes a coloured copy of a mesh. Triangles with defects are painted all over with the
 * defect's colour. So are the neighbours of triangles without area, which cannot be seen. The
 * other triangles are grey; with distances they run from grey at 0 through yellow to red at
 * full_mm. Painted triangles share no vertex with triangles of another colour, so the copy is
 * only for looking at.
 *
 * defects    triangle_count sets of cw_defect, as the checks leave them
 * distances  vertex_count, mm, such as cw_field_distance_desc.worst; or NULL. Kept as scalars
 * full_mm    the distance that is shown in red; 0: distances are not shown
 * out        filled on success, emptied on failure; free it with cw_mesh_free()
 * Returns    CW_ERR_ARGUMENT as cw_mesh_check(); CW_ERR_LIMIT; CW_ERR_NO_MEMORY */
CW_NODISCARD CW_API cw_status cw_check_paint(const cw_mesh *mesh, const uint8_t *defects,
                                             const float *distances, double full_mm,
                                             cw_mesh *out, cw_error *err);

#ifdef __cplusplus
}
#endif

#endif
