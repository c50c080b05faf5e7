// C++20 over the C calls: structs that own their memory, spans over arrays, and errors as
// exceptions or not.
//
// Each function has two forms. With a cw_error as its last argument it throws nothing, and returns
// an empty std::optional on failure. Without one it throws cubewright::error. Options are the
// structs of C, and so are units, frames, threads and costs: see the call that a function names.
// A call without a function here is made by call(), with owners of its results:
//
//     cubewright::mesh m = cubewright::extract(volume, {.isovalue = 0.5});
//     cubewright::call(cw_mesh_smooth, m.get(), nullptr, nullptr);
#ifndef CUBEWRIGHT_HPP
#define CUBEWRIGHT_HPP

#include <cubewright/cubewright.h>

#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>

namespace cubewright
{

// A call that failed: its message, and its status.
class error : public std::runtime_error
{
public:
    error(cw_status status, const cw_error &err) : runtime_error(err.message), status_(status)
    {
    }
    cw_status status() const noexcept
    {
        return status_;
    }

private:
    cw_status status_;
};

// Calls a function of C whose last argument is a cw_error, which is added. Throws error.
template <class F, class... A> void call(F function, A &&...arguments)
{
    cw_error err{};
    const cw_status status = function(std::forward<A>(arguments)..., &err);
    if (status != CW_OK)
        throw error(status, err);
}

// Owns a struct of the library. It can be moved, not copied.
template <class T, void (*Free)(T *)> class owner
{
public:
    owner() noexcept = default;
    explicit owner(T taken) noexcept : value_(taken)
    {
    }
    owner(owner &&from) noexcept : value_(from.release())
    {
    }
    owner &operator=(owner &&from) noexcept
    {
        const T taken = from.release(); // also of itself
        *refill() = taken;
        return *this;
    }
    ~owner()
    {
        Free(&value_);
    }

    T *get() noexcept
    {
        return &value_;
    }
    const T *get() const noexcept
    {
        return &value_;
    }
    T *operator->() noexcept
    {
        return &value_;
    }
    const T *operator->() const noexcept
    {
        return &value_;
    }
    operator const T &() const noexcept
    {
        return value_;
    }

    // Frees what is there, for a call that fills the struct.
    T *refill() noexcept
    {
        Free(&value_);
        value_ = T{};
        return &value_;
    }
    // Gives the struct away, to be freed by the caller.
    T release() noexcept
    {
        return std::exchange(value_, T{});
    }

private:
    T value_{};
};

template <class E>
concept error_place = std::same_as<E, cw_error>;

namespace detail
{

// Makes a value by a function that fills it. E is cw_error, or none to throw.
template <class Out, error_place... E> struct maker {
    std::array<cw_error *, sizeof...(E)> places;

    template <class F> auto operator()(F fill) const
    {
        if constexpr (sizeof...(E) == 0) {
            Out out;
            call([&](cw_error *err) { return fill(out, err); });
            return out;
        } else {
            std::optional<Out> out(std::in_place);
            if (fill(*out, places[0]) != CW_OK)
                out.reset();
            return out;
        }
    }
};

template <class T> constexpr cw_type type_of()
{
    static_assert(std::floating_point<T> || (std::integral<T> && sizeof(T) <= 4),
                  "voxels are integers of up to 32 bits, float or double");
    if (std::floating_point<T>)
        return sizeof(T) == 4 ? CW_F32 : CW_F64;
    constexpr cw_type signs[] = {CW_I8, CW_I16, CW_I32}, plain[] = {CW_U8, CW_U16, CW_U32};
    return (std::is_signed_v<T> ? signs : plain)[sizeof(T) / 2];
}

inline std::string text_of(const std::filesystem::path &path) // in UTF-8
{
    const auto text = path.u8string();
    return {text.begin(), text.end()};
}

inline cw_byte_source source_of(std::span<const std::byte> file, const char *name)
{
    cw_byte_source source{};
    source.name = name, source.bytes = file.data(), source.size = file.size();
    return source;
}

inline void free_extractor(cw_extractor **extractor)
{
    cw_extractor_free(*extractor);
}
inline void free_bytes(std::span<std::uint8_t> *bytes)
{
    cw_bytes_free(bytes->data());
}

} // namespace detail

// --- volumes ----------------------------------------------------------------------------------

using volume = owner<cw_volume, cw_volume_free>;

// Returns a volume over voxels of the caller, which must outlive it; x varies fastest.
// dim      voxels along x, y, z; CW_ERR_ARGUMENT if their product is not the size of the span
// spacing  millimetres between voxels; origin: world point of the first one
template <class T, error_place... E>
auto view_volume(std::span<const T> voxels, std::array<std::size_t, 3> dim,
                 std::array<double, 3> spacing = {1, 1, 1},
                 std::array<double, 3> origin = {0, 0, 0}, E &...err)
{
    return detail::maker<volume, E...>{&err...}([&](volume &out, cw_error *e) {
        const std::size_t layer = dim[0] * dim[1];
        if (!layer || voxels.size() % layer || voxels.size() / layer != dim[2]) {
            std::strcpy(e->message, "the span has another number of voxels than dim");
            return CW_ERR_ARGUMENT;
        }
        out->data = voxels.data();
        out->type = detail::type_of<T>();
        for (int a = 0; a < 3; a++) {
            out->dim[a] = dim[a];
            out->affine[a][a] = spacing[a];
            out->affine[a][3] = origin[a];
        }
        cw_volume resolved;
        return cw_volume_resolve(out.get(), &resolved, e);
    });
}

// cw_volume_read()
template <error_place... E>
auto read_volume(const std::filesystem::path &path, const cw_read_desc &desc = {}, E &...err)
{
    return detail::maker<volume, E...>{&err...}([&](volume &out, cw_error *e) {
        return cw_volume_read(detail::text_of(path).c_str(), &desc, out.refill(), nullptr, e);
    });
}

// cw_volume_read_memory(). name: a file name, where content does not tell the format
template <error_place... E>
auto read_volume(std::span<const std::byte> file, const char *name = nullptr,
                 const cw_read_desc &desc = {}, E &...err)
{
    const auto source = detail::source_of(file, name);
    return detail::maker<volume, E...>{&err...}([&](volume &out, cw_error *e) {
        return cw_volume_read_memory(&source, &desc, out.refill(), nullptr, e);
    });
}

// --- meshes -----------------------------------------------------------------------------------

// A mesh. Spans are valid until it is filled again, moved or destroyed.
class mesh : public owner<cw_mesh, cw_mesh_free>
{
public:
    using owner::owner;
    // x, y, z of each vertex, millimetres, relative to get()->origin.
    std::span<float> positions() const
    {
        return {(*this)->positions, 3 * (*this)->vertex_count};
    }
    // Unit normals, outward. Empty for a mesh without normals.
    std::span<float> normals() const
    {
        return {(*this)->normals, (*this)->normals ? 3 * (*this)->vertex_count : 0};
    }
    // Three vertices of each triangle, counter-clockwise seen from outside.
    std::span<std::uint32_t> triangles() const
    {
        return {(*this)->triangles, 3 * (*this)->triangle_count};
    }
};

// Returns a mesh over arrays of the caller, which must outlive it; cw_mesh_check() checks them.
inline cw_mesh view_mesh(std::span<const float> positions,
                         std::span<const std::uint32_t> triangles)
{
    cw_mesh view{};
    view.vertex_count = positions.size() / 3;
    view.triangle_count = triangles.size() / 3;
    view.positions = const_cast<float *>(positions.data()); // a const mesh is not written
    view.triangles = const_cast<std::uint32_t *>(triangles.data());
    return view;
}

// cw_mesh_read()
template <error_place... E>
auto read_mesh(const std::filesystem::path &path, const cw_mesh_read_desc &desc = {}, E &...err)
{
    return detail::maker<mesh, E...>{&err...}([&](mesh &out, cw_error *e) {
        return cw_mesh_read(detail::text_of(path).c_str(), &desc, out.refill(), nullptr, e);
    });
}

// cw_mesh_read_memory()
template <error_place... E>
auto read_mesh(std::span<const std::byte> file, const char *name = nullptr,
               const cw_mesh_read_desc &desc = {}, E &...err)
{
    const auto source = detail::source_of(file, name);
    return detail::maker<mesh, E...>{&err...}([&](mesh &out, cw_error *e) {
        return cw_mesh_read_memory(&source, &desc, out.refill(), nullptr, e);
    });
}

// The bytes of a file in memory.
using bytes = owner<std::span<std::uint8_t>, detail::free_bytes>;

// cw_mesh_write_memory(). name: a file name, whose extension is the format
template <error_place... E>
auto write_mesh(const char *name, const cw_mesh &input, const cw_write_desc &desc = {},
                E &...err)
{
    return detail::maker<bytes, E...>{&err...}([&](bytes &out, cw_error *e) {
        std::uint8_t *data = nullptr;
        std::size_t size = 0;
        const cw_status status = cw_mesh_write_memory(name, &input, &desc, &data, &size, e);
        *out.refill() = {data, size};
        return status;
    });
}

// --- surfaces ---------------------------------------------------------------------------------

// cw_extract()
template <error_place... E>
auto extract(const cw_volume &input, const cw_extract_desc &desc = {}, E &...err)
{
    return detail::maker<mesh, E...>{&err...}([&](mesh &out, cw_error *e) {
        return cw_extract(&input, &desc, out.refill(), nullptr, e);
    });
}

// cw_simplify()
template <error_place... E>
auto simplify(const cw_mesh &input, const cw_simplify_desc &desc, E &...err)
{
    return detail::maker<mesh, E...>{&err...}([&](mesh &out, cw_error *e) {
        return cw_simplify(&input, &desc, out.refill(), nullptr, e);
    });
}

// cw_extractor_new(): several surfaces of a volume, or of one that changes. It borrows the volume;
// see cw_extractor_extract() and cw_extractor_update() for call().
using extractor = owner<cw_extractor *, detail::free_extractor>;
template <error_place... E> auto make_extractor(const cw_volume &input, E &...err)
{
    return detail::maker<extractor, E...>{&err...}(
        [&](extractor &out, cw_error *e) { return cw_extractor_new(&input, out.refill(), e); });
}

// Returns a progress that calls a function: bool(const char *step, double done). false cancels, as
// an exception of it does. The function must outlive the call that uses it.
template <class F> cw_progress progress_of(F &function)
{
    const auto report = [](void *user, const char *step, double done) {
        try {
            return static_cast<bool>((*static_cast<F *>(user))(step, done));
        } catch (...) { // may not pass through C
            return false;
        }
    };
    return {report, const_cast<void *>(static_cast<const void *>(&function))};
}

} // namespace cubewright

#endif
