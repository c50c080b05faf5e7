/* The function that every module exports beside its struct of functions. A program that links the static
 * library has our functions twice, its own and those of the shared library that modules use; the memory
 * account and the threads are the program's. */
#include "core/base/memory.h"
#include "core/base/module.h"
#include "core/base/thread_pool.h"

void cwi_module_attach(cwi_memory_account *account, cwi_thread_pool *pool)
{
    cwi_memory_account_share(account);
    cwi_thread_pool_share(pool);
}
