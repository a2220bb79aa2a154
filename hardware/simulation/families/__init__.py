"""Families of objects made by code, each with what is true of it: nobody chose them one by one."""
