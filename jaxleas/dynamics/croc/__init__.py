"""Transition feasibility by CROC: can the centre of mass cross from one support to the next?"""
