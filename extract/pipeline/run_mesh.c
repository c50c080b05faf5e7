/* Runs the pipeline on a mesh that is there. */
#include "core/base/status.h"
#include "core/mesh/mesh.h"
#include "extract/pipeline/stages.h"

cw_status cwi_copy_surface(cwi_pipeline *p, cw_mesh *mesh, cw_error *err)
{
    p->facts.extracted.triangles = p->given->triangle_count;
    p->facts.extracted.vertices = p->given->vertex_count;
    if (!p->given->triangle_count)
        return cwi_fail(err, CW_ERR_EMPTY, "the mesh has no triangles");
    cw_status st = cwi_mesh_copy(p->given, mesh, err);
    if (p->desc->atlas) /* its seams are no longer to be kept */
        cw_mesh_attribute_remove(mesh, CW_TEXTURE_COORDINATES);
    return st;
}

cw_status cw_pipeline_run_mesh(const cw_mesh *mesh, const cw_pipeline_desc *desc,
                               cw_pipeline_sink sink, cw_pipeline_facts *facts, cw_error *err)
{
    CWI_REQUIRE(err, mesh, desc);
    CWI_REQUIRE_VERSION(err, desc, 0);
    CWI_REQUIRE_VERSION(err, facts, 0);
    cw_status st = cw_mesh_check(mesh, err);
    cwi_pipeline p = {.desc = desc, .given = mesh};
    return st == CW_OK ? cwi_start_pipeline(&p, CW_SOURCE_MESH, sink, facts, err) : st;
}
