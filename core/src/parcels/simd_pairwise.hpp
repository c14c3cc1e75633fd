// Operators of a value that is a pair {first, second}, each applied to one half after the other:
// for the Pack of two registers and for the Twin of two Packs.
#pragma once

// A type and an operator cannot stand in parentheses.
// NOLINTBEGIN(bugprone-macro-parentheses)
#define PILEUS_PAIRWISE_ARITHMETIC(PAIR, OP)                \
  static inline PAIR operator OP(PAIR a, PAIR b) {          \
    return {a.first OP b.first, a.second OP b.second};      \
  }                                                         \
  static inline PAIR operator OP(PAIR a, double b) {        \
    return {a.first OP b, a.second OP b};                   \
  }                                                         \
  static inline PAIR operator OP(double a, PAIR b) {        \
    return {a OP b.first, a OP b.second};                   \
  }                                                         \
  template <class T>                                        \
  static inline PAIR& operator OP##=(PAIR& a, const T& b) { \
    return a = a OP b;                                      \
  }

#define PILEUS_PAIRWISE_COMPARISON(PAIR, MASK, OP)     \
  static inline MASK operator OP(PAIR a, PAIR b) {     \
    return {a.first OP b.first, a.second OP b.second}; \
  }                                                    \
  static inline MASK operator OP(PAIR a, double b) {   \
    return {a.first OP b, a.second OP b};              \
  }

#define PILEUS_PAIRWISE_OPERATORS(PAIR, MASK)        \
  PILEUS_PAIRWISE_ARITHMETIC(PAIR, +)                \
  PILEUS_PAIRWISE_ARITHMETIC(PAIR, -)                \
  PILEUS_PAIRWISE_ARITHMETIC(PAIR, *)                \
  PILEUS_PAIRWISE_ARITHMETIC(PAIR, /)                \
  PILEUS_PAIRWISE_COMPARISON(PAIR, MASK, <)          \
  PILEUS_PAIRWISE_COMPARISON(PAIR, MASK, <=)         \
  PILEUS_PAIRWISE_COMPARISON(PAIR, MASK, >)          \
  PILEUS_PAIRWISE_COMPARISON(PAIR, MASK, >=)         \
  static inline PAIR operator-(PAIR a) {             \
    return {-a.first, -a.second};                    \
  }                                                  \
  static inline MASK operator&(MASK a, MASK b) {     \
    return {a.first & b.first, a.second & b.second}; \
  }
// NOLINTEND(bugprone-macro-parentheses)
