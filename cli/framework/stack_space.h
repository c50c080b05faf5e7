/* Room for the stack of the first thread, asked for at the start. */
#ifndef CLI_FRAMEWORK_STACK_SPACE_H
#define CLI_FRAMEWORK_STACK_SPACE_H

/* Makes the stack as large as the program needs. Where the system does not give it, says so and ends the
 * process (8): later that would be a fault at any place. */
void cli_reserve_stack(void);

#endif
