// The boundary between C and a C++ library: nothing thrown crosses it.
#ifndef CORE_BASE_GUARD_HPP
#define CORE_BASE_GUARD_HPP

#include "core/base/memory.h"
#include "core/base/status.h"

#include <exception>
#include <new>

namespace cw
{

// Memory that a library allocates by itself, counted by an estimate during the lifetime of this
// object.
class Taken
{
public:
    explicit Taken(size_t bytes_) : bytes(bytes_)
    {
        if (!cwi_memory_take(bytes))
            throw std::bad_alloc();
    }
    ~Taken()
    {
        cwi_memory_give(bytes);
    }
    Taken(const Taken &) = delete;
    Taken &operator=(const Taken &) = delete;

private:
    size_t bytes;
};

// Thrown when the caller's progress callback stops the call.
struct Cancelled {
};

// Runs a function that returns cw_status. bad_alloc becomes CW_ERR_NO_MEMORY, Cancelled becomes
// CW_ERR_CANCELLED. Everything else becomes CW_ERR_BACKEND with the name and message of the
// library.
template <typename Body>
cw_status guard(cw_error *err, const char *library, Body &&body) noexcept
{
    try {
        return body();
    } catch (const std::bad_alloc &) {
        return cwi_fail_in(err, cwi_fail_memory(err), library);
    } catch (const Cancelled &) {
        return cwi_fail(err, CW_ERR_CANCELLED, "interrupted in %s", library);
    } catch (const std::exception &e) {
        return cwi_fail(err, CW_ERR_BACKEND, "%s failed: %s", library, e.what());
    } catch (...) {
        return cwi_fail(err, CW_ERR_BACKEND, "%s failed without saying why", library);
    }
}

} // namespace cw

#endif
