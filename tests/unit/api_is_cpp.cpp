// The same from C++: the headers compile, and link with C names.
#include <cubewright/cubewright.h>

int main()
{
    cw_mesh mesh = {};
    cw_volume volume = {};
    cw_mesh_free(&mesh);
    cw_volume_free(&volume);
    return cw_status_exit_code(CW_OK);
}
