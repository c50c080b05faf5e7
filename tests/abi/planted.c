/* A library whose header ends with cw_hidden, and changes of it by macros. */
typedef enum cw_planted_size {
#ifdef ADD_FIRST
    CW_PLANTED_TINY,
#endif
    CW_PLANTED_SMALL,
    CW_PLANTED_LARGE,
#ifdef ADD_LAST
    CW_PLANTED_HUGE,
#endif
    CW_PLANTED_COUNT
} cw_planted_size;

typedef struct cw_planted {
    cw_planted_size size;
#ifdef WIDEN
    double width;
#else
    int width;
#endif
#ifdef GROW
    int height;
#endif
} cw_planted;

typedef struct cw_planted_desc {
    unsigned version;
    double depth;
    int width;
#ifdef FILL /* what was padding */
    int height;
#endif
#ifdef LENGTHEN
    double height;
#endif
} cw_planted_desc;

typedef struct cw_hidden cw_hidden;

int cw_take(const cw_planted_desc *desc);
int cw_take(const cw_planted_desc *desc)
{
    return desc->width;
}

int cw_first(const cw_planted *planted
#ifdef ADD_PARAMETER
             ,
             int depth
#endif
);
int cw_first(const cw_planted *planted
#ifdef ADD_PARAMETER
             ,
             int depth
#endif
)
{
#ifdef ADD_PARAMETER
    return planted->size + depth;
#else
    return planted->size;
#endif
}

struct cw_hidden {
    int a;
#ifdef PRIVATE
    int b;
#endif
};

int cw_peek(const cw_hidden *hidden);
int cw_peek(const cw_hidden *hidden)
{
    return hidden->a;
}

#ifndef REMOVE_FUNCTION
int cw_second(void);
int cw_second(void)
{
    return 2;
}
#endif

#ifdef ADD_FUNCTION
int cw_third(void);
int cw_third(void)
{
    return 3;
}
#endif
