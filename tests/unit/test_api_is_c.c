/* Every public header stands alone, and the umbrella holds them all. */
#include <cubewright/distance.h>

#include <cubewright/quality.h>

#include <cubewright/formats.h>

#include <cubewright/field.h>

#include <cubewright/hard.h>

#include <cubewright/extract.h>

#include <cubewright/cubewright.h>

int main(void)
{
    cw_mesh mesh = {0};
    cw_volume volume = {0};
    cw_mesh_free(&mesh);
    cw_volume_free(&volume);
    return cw_status_exit_code(CW_OK);
}
