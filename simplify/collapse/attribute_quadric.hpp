// Attributes of vertices as linear functions of place, so that losing them costs like moving.
#ifndef SIMPLIFY_COLLAPSE_ATTRIBUTE_QUADRIC_HPP
#define SIMPLIFY_COLLAPSE_ATTRIBUTE_QUADRIC_HPP

#include "simplify/collapse/quadric.hpp"

#include <algorithm>
#include <vector>

namespace cw
{

// Around a vertex each attribute follows a line, another one in each triangle. How far these
// are from their mean, squared and over the area, is a quadric of place: that of [Hoppe1999]
// with the attributes of the vertex at their best. Areas that become one are put together as
// samples are [Chan1979]: what their means differ by is added to the quadric, so that it only
// grows.
class AttributeGradients
{
public:
    explicit AttributeGradients(const cwi_mesh_block &block)
        : count(block.attributes), areas(count ? block.vertices : 0),
          all(count * block.vertices)
    {
        if (!block.gradients || !count)
            return;
        std::copy_n(block.areas, areas.size(), areas.begin());
        std::copy_n(block.gradients, all.size(), all.begin());
    }

    bool is_requested() const
    {
        return count > 0;
    }

    size_t size() const
    {
        return count;
    }

    float area(size_t vertex) const
    {
        return areas[vertex];
    }

    const cwi_attribute_gradient *of(size_t vertex) const
    {
        return &all[vertex * count];
    }

    // Values of a triangle's corners.
    using Values = float[3][CWI_MAX_ATTRIBUTES];

    // Adds a triangle, by the sides from its first corner. Slivers have no gradients, and vertices for
    // which quadric_of is NULL get none.
    template <typename Quadric>
    void add_face(const size_t corner[3], const Vec &ab, const Vec &ac, const Values &values,
                  Quadric &&quadric_of)
    {
        const Vec normal = ab % ac, to_b = ac % normal, to_c = normal % ab;
        const float normal_sq = normal.sqrnorm(),
                    longest =
                        std::max(ab.sqrnorm(), std::max(ac.sqrnorm(), (ac - ab).sqrnorm()));
        if (!(normal_sq > 1e-7f * longest * longest))
            return;
        for (size_t k = 0; k < count; k++) {
            const float a = values[0][k];
            const Vec slope =
                ((values[1][k] - a) * to_b + (values[2][k] - a) * to_c) / normal_sq;
            std::copy_n(slope.data(), 3, joined[k].slope);
        }
        for (size_t i = 0; i < 3; i++) {
            cwi_quadric *quadric = quadric_of(corner[i]);
            if (!quadric)
                continue;
            for (size_t k = 0; k < count; k++)
                joined[k].value = values[i][k];
            cwi_attribute_gradients_join(quadric, &areas[corner[i]], &all[corner[i] * count],
                                         0.5f * std::sqrt(normal_sq), joined, count);
        }
    }

    // Joins the gradients of two vertices about the first, and adds their difference to the
    // quadric.
    void join(size_t at, size_t other, const Vec &displacement, cwi_quadric &quadric)
    {
        joined_area = areas[other];
        std::copy_n(of(other), count, joined);
        move(-displacement);
        cwi_attribute_gradients_join(&quadric, &joined_area, joined, areas[at], of(at), count);
    }

    // Drops what was joined at a vertex.
    void drop(size_t vertex)
    {
        areas[vertex] = 0;
    }

    // The loss where the last attributes of a vertex become other values at a displacement from it.
    float loss(size_t vertex, const Vec &displacement, const float *values, size_t last) const
    {
        float sum = 0;
        for (size_t k = 0; k < last; k++) {
            const cwi_attribute_gradient &g = of(vertex)[count - last + k];
            const float difference = g.value + (Vec(g.slope) | displacement) - values[k];
            sum += difference * difference;
        }
        return areas[vertex] * sum;
    }

    // Stores what was joined at a vertex, `displacement` from where that was.
    void put(size_t vertex, const Vec &displacement)
    {
        move(displacement);
        areas[vertex] = joined_area;
        std::copy_n(joined, count, &all[vertex * count]);
    }

private:
    void move(const Vec &displacement)
    {
        for (size_t k = 0; k < count; k++)
            joined[k].value += Vec(joined[k].slope) | displacement;
    }

    size_t count;
    std::vector<float> areas;
    std::vector<cwi_attribute_gradient> all; // vertices x count
    cwi_attribute_gradient joined[CWI_MAX_ATTRIBUTES];
    float joined_area = 0;
};

} // namespace cw

#endif
