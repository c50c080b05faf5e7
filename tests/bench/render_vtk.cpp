// Renders a scene with vtkGPUVolumeRayCastMapper or vtkFixedPointVolumeRayCastMapper, and times
// the frames.
#include "render_vtk.h"
#include "bench.h"

#include <vtkAutoInit.h>
VTK_MODULE_INIT(vtkRenderingOpenGL2)
VTK_MODULE_INIT(vtkRenderingVolumeOpenGL2)

#include <vtkCamera.h>
#include <vtkColorTransferFunction.h>
#include <vtkFixedPointVolumeRayCastMapper.h>
#include <vtkFloatArray.h>
#include <vtkGPUVolumeRayCastMapper.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPiecewiseFunction.h>
#include <vtkPointData.h>
#include <vtkRenderWindow.h>
#include <vtkRenderer.h>
#include <vtkSmartPointer.h>
#include <vtkUnsignedCharArray.h>
#include <vtkVolume.h>
#include <vtkVolumeProperty.h>

#include <algorithm>
#include <cstdlib>
#include <vector>

namespace
{

vtkSmartPointer<vtkImageData> image_of(const cw_volume &v)
{
    auto image = vtkSmartPointer<vtkImageData>::New();
    vtkNew<vtkFloatArray> values;
    const vtkIdType count = vtkIdType(v.dim[0] * v.dim[1] * v.dim[2]);
    values->SetArray(const_cast<float *>(static_cast<const float *>(v.data)), count, 1);
    image->SetDimensions(int(v.dim[0]), int(v.dim[1]), int(v.dim[2]));
    image->SetSpacing(v.affine[0][0], v.affine[1][1], v.affine[2][2]);
    image->SetOrigin(v.affine[0][3], v.affine[1][3], v.affine[2][3]);
    image->GetPointData()->SetScalars(values);
    return image;
}

void set_transfer(const cw_scene &s, vtkVolumeProperty *property)
{
    vtkNew<vtkColorTransferFunction> colors;
    vtkNew<vtkPiecewiseFunction> opacities;
    const cw_transfer &t = *s.transfer;
    for (size_t n = 0; n < t.color_count; n++)
        colors->AddRGBPoint(t.colors[n].value, t.colors[n].color[0], t.colors[n].color[1],
                            t.colors[n].color[2]);
    for (size_t n = 0; n < t.opacity_count; n++) /* our mip shows the colour alone */
        opacities->AddPoint(t.opacities[n].value,
                            s.mode == CW_MODE_MIP ? 1 : t.opacities[n].opacity);
    property->SetColor(colors);
    property->SetScalarOpacity(opacities);
    property->SetScalarOpacityUnitDistance(s.volume->affine[0][0]);
    property->SetInterpolationTypeToLinear();
    property->SetShade(s.lit);
    property->SetAmbient(0.25);
    property->SetDiffuse(0.75);
    property->SetSpecular(0.2);
    property->SetSpecularPower(32);
}

vtkSmartPointer<vtkVolumeMapper> mapper_of(const cw_scene &s, bool gpu)
{
    const double step = s.volume->affine[0][0] * (s.step_vox > 0 ? s.step_vox : 1);
    if (gpu) {
        auto mapper = vtkSmartPointer<vtkGPUVolumeRayCastMapper>::New();
        mapper->SetAutoAdjustSampleDistances(0);
        mapper->SetSampleDistance(float(step));
        mapper->SetImageSampleDistance(1);
        mapper->SetUseJittering(0);
        return mapper;
    }
    auto mapper = vtkSmartPointer<vtkFixedPointVolumeRayCastMapper>::New();
    mapper->SetAutoAdjustSampleDistances(0);
    mapper->SetSampleDistance(float(step));
    mapper->SetImageSampleDistance(1);
    return mapper;
}

void set_camera(const cw_camera &c, vtkRenderer *renderer)
{
    vtkCamera *camera = renderer->GetActiveCamera();
    camera->SetPosition(c.eye);
    camera->SetFocalPoint(c.target);
    camera->SetViewUp(c.up);
    camera->SetViewAngle(c.fov_deg);
    renderer->ResetCameraClippingRange();
}

} // namespace

bool bench_vtk_render(const cw_scene *scene, bool gpu, int frames, bench_vtk_times *times,
                      unsigned char *bytes)
{
    if (!std::getenv("DISPLAY"))
        return false;
    vtkNew<vtkRenderWindow> window;
    vtkNew<vtkRenderer> renderer;
    vtkNew<vtkVolume> volume;
    vtkNew<vtkVolumeProperty> property;
    vtkNew<vtkUnsignedCharArray> pixels;
    auto mapper = mapper_of(*scene, gpu);
    mapper->SetInputDataObject(image_of(*scene->volume));
    if (scene->mode == CW_MODE_MIP)
        mapper->SetBlendModeToMaximumIntensity();
    set_transfer(*scene, property);
    volume->SetMapper(mapper);
    volume->SetProperty(property);
    window->SetMultiSamples(0);
    window->SetSize(int(scene->width), int(scene->height));
    window->SetOffScreenRendering(1);
    window->AddRenderer(renderer);
    window->Render(); /* of an empty view: the context's own time is not counted */
    renderer->AddVolume(volume);
    set_camera(scene->camera, renderer);
    std::vector<double> all;
    for (int n = 0; n <= frames; n++) {
        volume->Modified();
        const double start = bench_cpu_ms();
        window->Render();
        window->GetPixelData(0, 0, int(scene->width) - 1, int(scene->height) - 1, 1, pixels);
        all.push_back(bench_cpu_ms() - start);
    }
    times->first_ms = all[0];
    std::sort(all.begin() + 1, all.end());
    times->next_ms = all[frames > 0 ? size_t(1 + frames / 2) : 0];
    if (bytes)
        std::copy(pixels->GetPointer(0),
                  pixels->GetPointer(0) + 3 * scene->width * scene->height, bytes);
    return true;
}
