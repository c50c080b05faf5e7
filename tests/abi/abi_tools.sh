#!/bin/sh
# Compares the binary interfaces of shared libraries with libabigail. The other scripts of this
# folder source it.

# True if a library has debug information, without which types are not known.
has_debug_info() { # LIBRARY
    readelf -S -W "$1" | grep -q ' \.debug_info '
}

# Prints the number of a library's soname, such as 0 of libcubewright.so.0.
soname_number() { # LIBRARY
    readelf -d "$1" | sed -n 's/.*SONAME.*\.so\.\([0-9]*\)\]$/\1/p'
}

# Writes the interface of a library: exported symbols without the internal ones (cwi_), and the types of the public headers. Paths,
# lines, needed libraries and the processor are left out, so that builds give the same dump.
dump_interface() { # LIBRARY HEADERS_FOLDER OUTPUT.abi
    printf '[suppress_function]\n  symbol_name_regexp = ^cwi_\n  drop = yes\n[suppress_variable]\n  symbol_name_regexp = ^cwi_\n  drop = yes\n' >"$3.suppr"
    abidw --suppressions "$3.suppr" --headers-dir "$2" --drop-private-types --exported-interfaces-only --no-corpus-path \
        --no-comp-dir-path --no-show-locs --no-elf-needed --no-architecture --no-parameter-names \
        --out-file "$3" "$1"
}

# Compares a library with a dump. Additions pass: functions, and enumerators at the end, which
# change the enumerator that counts them. All other changes are printed and fail, unless the
# number of the soname is higher than that of the dump.
compare_interface() { # DUMP.abi LIBRARY HEADERS_FOLDER FOLDER_FOR_FILES
    old=$(sed -n "1s/.*soname='[^']*\.so\.\([0-9]*\)'.*/\1/p" "$1")
    new=$(soname_number "$2")
    [ -n "$old" ] && [ -n "$new" ] || { echo "the soname has no number: '$old' before, '$new' now"; return 1; }
    if [ "$new" -gt "$old" ]; then
        echo "the soname's number was raised from $old to $new: breaks are allowed until the release"
        return 0
    fi
    counters=$(grep -h -o 'CW_[A-Z_]*_COUNT\>' "$3"/*.h | sort -u | paste -s -d , -)
    printf '[suppress_type]\n  type_kind = enum\n  changed_enumerators = %s\n' "$counters" >"$4/suppressed"
    status=0
    dump_interface "$2" "$3" "$4/now.abi" || return 1
    abidiff --no-added-syms --no-show-locs --suppr "$4/suppressed" "$1" "$4/now.abi" >"$4/report" 2>&1 || status=$?
    [ "$status" = 0 ] && return 0
    cat "$4/report"
    echo "the interface broke: undo that, or raise SOVERSION in CMakeLists.txt, as CONTRIBUTING.md says"
    return 1
}
