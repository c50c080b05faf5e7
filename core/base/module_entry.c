/* The function that every module exports beside its struct of functions. A module has copies of
 * the internal functions that it calls; the memory account is the program's. */
#include "core/base/memory.h"
#include "core/base/module.h"

void cwi_module_attach(cwi_memory_account *of_the_program)
{
    cwi_memory_account_share(of_the_program);
}
